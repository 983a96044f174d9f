#include "common/picture/draw_picture.h"

#include <cairo.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "common/picture/canvas.h"
#include "common/picture/solids.h"
#include "common/picture/viewport.h"
#include "tests/support/values.h"

namespace troupe {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

Polygon Box(double min_x, double min_y, double max_x, double max_y) {
  return {{min_x, min_y}, {max_x, min_y}, {max_x, max_y}, {min_x, max_y}};
}

// A world made by hand: a map of two walls that adjoin, a table, and robots.
class WorldMaker {
 public:
  ModelId Add(const std::string& name, Shape shape, Color color, Pose X_PM = {}) {
    ModelDescription model{
        .name = name, .type = "model", .X_PM = X_PM, .shape = ShapeId(world.shapes.size()), .color = color};
    world.shapes.push_back(std::move(shape));
    world.models.push_back(model);
    return ModelId(world.models.size() - 1);
  }
  void AddMap() {
    Shape shape{.rectangles = {{-5, -5, 5, -4.4}, {-5, -4.4, -4.23, 5}}, .rectangles_z = {0.0, 1.0}};
    Add("map", shape, {0.3, 0.3, 0.3, 1.0});
  }
  void AddTable(Pose X_WM) {
    Shape shape;
    shape.blocks = {{Box(-1, -1, 1, 1), {0.7, 0.75}}, {Box(-1, -1, -0.9, -0.9), {0.0, 0.7}}};
    Add("table", shape, {0.9, 0.6, 0.2, 1.0}, X_WM);
  }
  RobotId AddRobot(const std::string& name, Pose X_WR, double size = 0.5) {
    Shape shape;
    shape.blocks = {{Box(-0.5 * size, -0.5 * size, 0.5 * size, 0.5 * size), {0.0, 0.3}}};
    world.robots.push_back(RobotDescription{.name = name, .root = Add(name, shape, {0.1, 0.2, 0.9, 1.0}, X_WR)});
    state.robots.push_back({X_WR, {}, false});
    return RobotId(world.robots.size() - 1);
  }

  WorldDescription world;
  WorldState state;
};

WorldMaker Demo() {
  WorldMaker maker;
  maker.world.name = "demo";
  maker.AddMap();
  maker.AddTable({2, 2, 0, 0});
  maker.AddRobot("r0", {-2, 0, 0, 0});
  maker.AddRobot("r1", {2, 2, 0, 1.0});
  return maker;
}

std::vector<ScanFan> DemoFans() {
  return {{{-2, 0, 0.2, 0}, 1.0, 3.0, {-0.5, 0.0, 0.5}, {2.0, 3.0, 2.0}}, {{2, 2, 0.2, 1}, 0.3, 3.0, {0.0}, {1.0}}};
}

struct Pixel {
  int r = 0;
  int g = 0;
  int b = 0;
  bool operator==(const Pixel&) const = default;
};
std::ostream& operator<<(std::ostream& out, const Pixel& p) {
  return out << p.r << ' ' << p.g << ' ' << p.b;
}

int Distance(const Pixel& a, const Pixel& b) {
  return std::abs(a.r - b.r) + std::abs(a.g - b.g) + std::abs(a.b - b.b);
}

// As Cairo rounds.
Pixel ToPixel(const Color& color) {
  const auto byte = [](double value) { return std::min(255, int(std::floor(256.0 * value))); };
  return {byte(color.r), byte(color.g), byte(color.b)};
}

// A drawn PNG, whose pixels are read by places in the world.
class Picture {
 public:
  Picture(const WorldMaker& maker, PictureOptions options = {}, const std::vector<ScanFan>& fans = {}) {
    const Result<std::string> bytes = DrawPicture(maker.world, maker.state, fans, options);
    EXPECT_TRUE(bytes.ok());
    if (!bytes.ok()) return;
    struct Source {
      const std::string* bytes;
      std::size_t at = 0;
    } source{&bytes.value()};
    const auto read = [](void* closure, unsigned char* data, unsigned int length) {
      auto* from = static_cast<Source*>(closure);
      if (from->at + length > from->bytes->size()) return CAIRO_STATUS_READ_ERROR;
      std::memcpy(data, from->bytes->data() + from->at, length);
      from->at += length;
      return CAIRO_STATUS_SUCCESS;
    };
    cairo_surface_t* surface = cairo_image_surface_create_from_png_stream(read, &source);
    EXPECT_EQ(cairo_surface_status(surface), CAIRO_STATUS_SUCCESS);
    width_ = cairo_image_surface_get_width(surface);
    height_ = cairo_image_surface_get_height(surface);
    const int stride = cairo_image_surface_get_stride(surface);
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) {
        std::uint32_t value;
        std::memcpy(&value, cairo_image_surface_get_data(surface) + y * stride + 4 * x, 4);
        pixels_.push_back({int(value >> 16 & 255), int(value >> 8 & 255), int(value & 255)});
      }
    }
    cairo_surface_destroy(surface);

    const std::vector<Solid> solids = CollectSolids(maker.world, maker.state);
    Rectangle contents = Rectangle::Nothing();
    for (const Solid& solid : solids) {
      const bool top = options.view == PictureView::kTop;
      if (!top && solid.kind == SolidKind::kMap) {
        contents.Extend(Vec2(solid.box.min_x, 0.0));
        contents.Extend(Vec2(solid.box.max_x, 0.0));
      } else {
        contents.Extend(top ? solid.box : Rectangle{solid.box.min_x, solid.z.min, solid.box.max_x, solid.z.max});
      }
    }
    viewport_ = MakeViewport(contents, options);
  }

  Pixel At(double x, double up) const {
    const Vec2 p = viewport_.ToPage(x, up);
    return AtPixel(int(std::floor(p.x())), int(std::floor(p.y())));
  }
  Pixel AtPixel(int x, int y) const {
    if (x < 0 || x >= width_ || y < 0 || y >= height_) {
      ADD_FAILURE() << x << ", " << y << " is not on the page";
      return {};
    }
    return pixels_[std::size_t(y) * width_ + x];
  }
  int Count(const Color& color) const { return int(std::count(pixels_.begin(), pixels_.end(), ToPixel(color))); }
  const Viewport& viewport() const { return viewport_; }
  int width() const { return width_; }
  int height() const { return height_; }

 private:
  int width_ = 0;
  int height_ = 0;
  std::vector<Pixel> pixels_;
  Viewport viewport_;
};

PictureOptions Side() {
  PictureOptions options;
  options.view = PictureView::kSide;
  return options;
}

TEST(DrawPicture, TheSameWorldGivesTheSameBytes) {
  const WorldMaker demo = Demo();
  for (PictureView view : {PictureView::kTop, PictureView::kSide}) {
    for (PictureFormat format : {PictureFormat::kPng, PictureFormat::kSvg}) {
      PictureOptions options{.view = view, .format = format};
      const Result<std::string> first = DrawPicture(demo.world, demo.state, DemoFans(), options);
      const Result<std::string> second = DrawPicture(demo.world, demo.state, DemoFans(), options);
      ASSERT_TRUE(first.ok() && second.ok());
      EXPECT_EQ(first.value(), second.value());
      EXPECT_THAT(first.value(), StartsWith(format == PictureFormat::kPng ? "\x89PNG" : "<?xml"));
    }
  }
}

TEST(DrawPicture, WallsAreDarkOnALightGround) {
  const Picture picture(Demo());
  const Color wall = WallColor({0.3, 0.3, 0.3, 1.0});
  EXPECT_EQ(picture.At(0, -4.7), ToPixel(wall));
  EXPECT_EQ(picture.At(-4.6, 3), ToPixel(wall));
  EXPECT_LT(Distance(picture.At(-0.55, -2.55), ToPixel(page::kGround)), 60);
}

TEST(DrawPicture, AdjoiningRectanglesShowNoSeam) {
  for (int width : {300, 517, 801, 1000}) {
    PictureOptions options;
    options.width = width;
    const Picture picture(Demo(), options);
    const Vec2 joint = picture.viewport().ToPage(-4.6, -4.4);
    for (int y = int(joint.y()) - 4; y <= int(joint.y()) + 4; ++y) {
      EXPECT_EQ(picture.AtPixel(int(joint.x()), y), ToPixel(WallColor({0.3, 0.3, 0.3, 1.0}))) << width << " " << y;
    }
  }
}

TEST(DrawPicture, ARobotHasItsModelsColor) {
  const Picture picture(Demo());
  EXPECT_EQ(picture.At(-2.15, 0.1), ToPixel(RobotColor({0.1, 0.2, 0.9, 1.0}, 1.0)));
}

TEST(DrawPicture, ANosePointsAhead) {
  WorldMaker demo = Demo();
  demo.state.robots[0].X_WR.heading = std::acos(-1.0);
  const Picture back(demo);
  const Picture ahead{Demo()};
  const Pixel body = ToPixel(RobotColor({0.1, 0.2, 0.9, 1.0}, 1.0));
  EXPECT_GT(Distance(ahead.At(-1.83, 0), body), 100);
  EXPECT_EQ(ahead.At(-2.17, 0), body);
  EXPECT_GT(Distance(back.At(-2.17, 0), body), 100);
  EXPECT_EQ(back.At(-1.83, 0), body);
}

TEST(DrawPicture, ANoseIsOnABodyThatIsBesideItsOrigin) {
  WorldMaker maker;
  maker.AddMap();
  Shape shape;
  shape.blocks = {{Box(1.0, 0.5, 2.0, 1.5), {0.0, 0.3}}, {Box(2.0, 0.95, 2.6, 1.05), {0.0, 0.1}}};
  RobotDescription robot;
  robot.name = "r0";
  robot.root = maker.Add("r0", shape, {0.1, 0.2, 0.9, 1.0});
  maker.world.robots.push_back(robot);
  maker.state.robots.push_back({});
  const Picture picture(maker);
  const Pixel body = ToPixel(RobotColor({0.1, 0.2, 0.9, 1.0}, 1.0));
  EXPECT_GT(Distance(picture.At(1.85, 1.0), body), 100);
  for (const double y : {0.0, 0.2, 0.4}) EXPECT_GT(Distance(picture.At(1.3, y), {255, 255, 255}), 5) << "not white";
  EXPECT_EQ(picture.At(1.2, 0.7), body);
}

TEST(DrawPicture, RaysAreSeenOverAFloorPlate) {
  WorldMaker demo = Demo();
  Shape plate;
  plate.blocks = {{Box(-4, -4, 4, 4), {0.0, 0.01}}};
  demo.Add("plate", plate, {0.8, 0.8, 0.4, 1.0});
  const Picture with(demo, {}, DemoFans());
  const Picture without(demo);
  EXPECT_GT(Distance(with.At(-0.9, 0.13), without.At(-0.9, 0.13)), 10);
  EXPECT_EQ(with.At(-3.1, 0.13), without.At(-3.1, 0.13));
}

TEST(DrawPicture, ARobotUnderATableCanBeSeenThroughIt) {
  WorldMaker without = Demo();
  without.state.robots[1].X_WR = {-2, 3, 0, 1.0};
  const Picture under{Demo()};
  const Picture away(without);
  const Pixel open = away.At(-2.1, 2.9);     // the robot in the open
  const Pixel covered = under.At(1.9, 1.9);  // the robot under the table
  const Pixel top = away.At(1.9, 1.9);       // the table alone
  EXPECT_GT(Distance(covered, top), 40);
  EXPECT_GT(Distance(covered, open), 40);
}

TEST(DrawPicture, HigherSolidsCoverLowerOnes) {
  WorldMaker maker;
  Shape shape;
  shape.blocks = {{Box(-1, -1, 1, 1), {0.05, 0.2}}, {Box(-2, -2, 2, 2), {0.0, 0.05}}};
  maker.Add("steps", shape, {0.2, 0.8, 0.2, 1.0});
  const Picture picture(maker);
  const Pixel low = picture.At(1.5, 1.5);
  const Pixel high = picture.At(0.5, 0.5);
  EXPECT_GT(high.r + high.g + high.b, low.r + low.g + low.b + 60);
}

TEST(DrawPicture, RaysTintTheGround) {
  const Picture with(Demo(), {}, DemoFans());
  const Picture without{Demo()};
  EXPECT_GT(Distance(with.At(-0.9, 0.13), without.At(-0.9, 0.13)), 10);
  EXPECT_EQ(with.At(-3.1, 0.13), without.At(-3.1, 0.13));
}

TEST(DrawPicture, StalledRobotsAreMarkedInRed) {
  WorldMaker demo = Demo();
  EXPECT_EQ(Picture(demo).Count(page::kStalled), 0);
  demo.state.robots[0].stalled = true;
  EXPECT_GT(Picture(demo).Count(page::kStalled), 40);
  EXPECT_GT(Picture(demo, Side()).Count(page::kStalled), 40);
  demo.world.models[demo.world.robots[0].root.index()].removed = true;
  EXPECT_EQ(Picture(demo).Count(page::kStalled), 0) << "not in the caption either";
}

// A floor is no lower object: it has its own colour, so that what stands on it is seen.
TEST(DrawPicture, FloorsAreLighterThanWhatStandsOnThem) {
  WorldMaker maker;
  Shape floor;
  floor.blocks = {{Box(-3, -3, 3, 3), {-0.1, 0.0}}};
  maker.Add("floor", floor, {0.9, 0.9, 0.9, 1.0});
  Shape walls;
  walls.blocks = {{Box(-1, -1, 1, 1), {0.0, 2.5}}};
  maker.Add("walls", walls, {0.4, 0.4, 0.4, 1.0});
  const Picture picture(maker);
  const Pixel below = picture.At(2, 2);
  const Pixel above = picture.At(0, 0);
  EXPECT_GT(below.r + below.g + below.b, above.r + above.g + above.b + 100);
}

TEST(DrawPicture, ASideViewShowsHeights) {
  const Picture picture(Demo(), Side());
  const Pixel free = picture.At(2.7, 0.45);                 // between table top and ground
  EXPECT_GT(Distance(picture.At(2.7, 0.725), free), 50);    // table top
  EXPECT_GT(Distance(picture.At(2.1, 0.1), free), 50);      // robot under it
  EXPECT_GT(Distance(picture.At(1.05, 0.4), free), 50);     // leg
  EXPECT_GT(Distance(picture.At(-2.15, 0.05), free), 50);   // robot in the open
  EXPECT_LT(Distance(picture.At(-2.15, 0.515), free), 40);  // nothing above it
}

TEST(DrawPicture, ASideViewOfAPartOmitsSolidsFarBehindOrInFront) {
  PictureOptions options = Side();
  options.center = Vec2(2, 2);
  options.meters = 3;
  WorldMaker demo = Demo();
  WorldMaker more = Demo();
  Shape screen;
  screen.blocks = {{Box(-1, -0.1, 1, 0.1), {0.0, 0.74}}};
  more.Add("screen", screen, {0, 0, 0, 1}, {2, -3, 0, 0});
  const auto draw = [&](const WorldMaker& maker) {
    const auto bytes = DrawPicture(maker.world, maker.state, {}, options);
    return bytes.ok() ? bytes.value() : "failed";
  };
  EXPECT_EQ(draw(demo), draw(more));
  options.meters = 12;
  EXPECT_NE(draw(demo), draw(more));
}

// Lanes of a campus: as dark along the axes as across them.
TEST(DrawPicture, ThinBarsAreLines) {
  WorldMaker maker;
  Shape lanes;
  lanes.blocks = {{Box(-150, -0.03, 150, 0.03), {0.0, 0.005}},
                  {{{-100.02, -100.0}, {-99.98, -100.0}, {100.02, 100.0}, {99.98, 100.0}}, {0.0, 0.005}}};
  maker.Add("lanes", lanes, {0.0, 0.0, 0.9, 1.0});
  const Picture picture(maker);
  const Pixel ground = picture.At(-60.3, 70.4);
  EXPECT_GT(Distance(picture.At(-60.3, 0.0), ground), 80);
  EXPECT_GT(Distance(picture.At(60.3, 60.3), ground), 80);
}

TEST(DrawPicture, AnEmptyWorldIsAnEmptyGrid) {
  WorldMaker nothing;
  EXPECT_GT(Picture(nothing).Count(page::kGround), 10000);
  EXPECT_GT(Picture(nothing, Side()).Count(page::kGround), 10000);
}

TEST(DrawPicture, RobotsOfAHugeWorldStayVisible) {
  WorldMaker maker;
  Shape shape{.rectangles = {{-500, -350, 500, -349}, {-500, 349, 500, 350}}, .rectangles_z = {0.0, 2.0}};
  maker.Add("site", shape, {0.3, 0.3, 0.3, 1.0});
  maker.AddRobot("r0", {100, 50, 0, 0});
  const Picture picture(maker);
  const Pixel robot = ToPixel(RobotColor({0.1, 0.2, 0.9, 1.0}, 0.7));
  EXPECT_EQ(picture.At(100, 50), robot);
  EXPECT_LE(picture.height(), 1000);
}

TEST(DrawPicture, ZoomingIntoAHugeWorldKeepsItsShapes) {
  WorldMaker maker;
  Shape shape{.rectangles = {{-1e7, -1e7, 0.0, 1e7}}, .rectangles_z = {0.0, 2.0}};
  maker.Add("half plane", shape, {0.3, 0.3, 0.3, 1.0});
  PictureOptions options{.center = Vec2(0, 0), .meters = 0.5};
  const Picture picture(maker, options);
  EXPECT_EQ(picture.At(-0.13, 0.03), ToPixel(WallColor({0.3, 0.3, 0.3, 1.0})));
  EXPECT_LT(Distance(picture.At(0.13, 0.03), ToPixel(page::kGround)), 60);
}

TEST(DrawPicture, ManyRobotsAreDrawnWithoutNumbersThatAreNone) {
  WorldMaker maker;
  for (int i = 0; i < 1000; ++i) maker.AddRobot("robot" + std::to_string(i), {i % 40 * 0.6, i / 40 * 0.6, 0, 0.1 * i});
  PictureOptions options;
  options.format = PictureFormat::kSvg;
  const std::string svg = test::ValueOf(DrawPicture(maker.world, maker.state, {}, options));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  EXPECT_THAT(svg, Not(HasSubstr("inf")));
}

// Every tag is closed in its order, and nothing outside of tags needs escaping.
bool WellFormed(const std::string& xml) {
  std::vector<std::string> open;
  for (std::size_t at = 0; at < xml.size();) {
    if (xml[at] != '<') {
      if (xml[at] == '>') return false;
      ++at;
      continue;
    }
    const std::size_t end = xml.find('>', at);
    if (end == std::string::npos) return false;
    const std::string tag = xml.substr(at + 1, end - at - 1);
    at = end + 1;
    if (tag.find('<') != std::string::npos || std::count(tag.begin(), tag.end(), '"') % 2 != 0) return false;
    if (tag.starts_with("?") || tag.starts_with("!") || tag.ends_with("/")) continue;
    const std::string name = tag.substr(0, tag.find_first_of(" \n"));
    if (!name.starts_with("/")) {
      open.push_back(name);
    } else if (open.empty() || "/" + open.back() != name) {
      return false;
    } else {
      open.pop_back();
    }
  }
  return open.empty();
}

TEST(DrawPicture, SvgIsWellFormedForAnyNames) {
  for (const std::string name : {"demo", "<&\">]]>", "\xff\xfe", "", "tab\tand\nline"}) {
    WorldMaker demo = Demo();
    demo.world.name = name;
    demo.world.robots[0].name = name;
    PictureOptions options;
    options.format = PictureFormat::kSvg;
    const std::string svg = test::ValueOf(DrawPicture(demo.world, demo.state, DemoFans(), options));
    EXPECT_TRUE(WellFormed(svg));
    EXPECT_THAT(svg, Not(HasSubstr("nan")));
  }
}

PictureOptions WithWidth(int width) {
  PictureOptions options;
  options.width = width;
  return options;
}

PictureOptions WithMeters(double meters) {
  PictureOptions options;
  options.meters = meters;
  return options;
}

PictureOptions WithCenter(double x, double y) {
  PictureOptions options;
  options.center = Vec2(x, y);
  return options;
}

TEST(DrawPicture, RefusesOptionsOutOfBounds) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const struct {
    PictureOptions options;
    std::string message;
  } cases[] = {
      {WithWidth(0), "found a picture width of 0, expected 200 to 4096 pixels"},
      {WithWidth(-5), "found a picture width of -5"},
      {WithWidth(100000), "found a picture width of 100000"},
      {WithMeters(0.0), "found a picture 0 m wide, expected 0.01 m to 1e9 m"},
      {WithMeters(-1.0), "found a picture -1 m wide"},
      {WithMeters(nan), "found a picture nan m wide"},
      {WithMeters(1e300), "found a picture 1e+300 m wide"},
      {WithCenter(nan, 0), "found a picture centre that is not a place"},
      {WithCenter(0, 1e30), "found a picture centre that is not a place"},
  };
  const WorldMaker demo = Demo();
  for (const auto& c : cases) {
    const Result<std::string> result = DrawPicture(demo.world, demo.state, {}, c.options);
    ASSERT_FALSE(result.ok()) << c.message;
    EXPECT_THAT(result.error().message, HasSubstr(c.message));
  }
}

TEST(DrawPicture, HasTheWidthAskedFor) {
  for (int width : {200, 640, 2000}) {
    PictureOptions options;
    options.width = width;
    EXPECT_EQ(Picture(Demo(), options).width(), width);
  }
}

// A block of 600 x 300 pixels of 1 cm with a checkerboard of 30 cm in it, turned.
WorldMaker MakerWithArea(double heading) {
  Bitmap bitmap(600, 300);
  for (int y = 0; y < 300; ++y) {
    for (int x = 0; x < 600; ++x) bitmap.set_occupied(x, y, (x / 30 + y / 30) % 2 == 0);
  }
  const PixelLines lines{.factor = 0.01};
  Shape shape{.rectangles_z = {0.0, 1.0},
              .area = PixelArea(std::make_shared<const DenseCover>(std::move(bitmap)), lines, lines)};
  WorldMaker maker;
  maker.Add("map", shape, {0.3, 0.3, 0.3, 1.0}, {-3.0, -1.5, 0.0, heading});
  return maker;
}

TEST(DrawPicture, AnAreaIsDrawnAtItsPlace) {
  for (const double heading : {0.0, 0.4}) {
    for (const std::optional<double> meters : {std::optional<double>(), std::optional(1.2)}) {
      const WorldMaker maker = MakerWithArea(heading);
      PictureOptions options;
      if (meters) {
        options.meters = meters;
        options.center = Vec2(-2.8, -1.0);
      }
      const Picture picture(maker, options);
      const Transform2 X_WM(maker.world.models[0].X_PM);
      const Pixel wall = ToPixel(WallColor({0.3, 0.3, 0.3, 1.0}));
      for (const auto& [i, j] : {std::pair(1, 1), std::pair(0, 1), std::pair(1, 0), std::pair(0, 2)}) {
        const Vec2 place = X_WM * Vec2(0.3 * i + 0.15, 0.3 * j + 0.15);
        if (meters && (place - *options.center).cwiseAbs().maxCoeff() > 0.35) continue;
        if ((i + j) % 2 == 0) {
          EXPECT_EQ(picture.At(place.x(), place.y()), wall) << heading << " " << i << " " << j;
        } else {
          EXPECT_GT(Distance(picture.At(place.x(), place.y()), wall), 100) << heading << " " << i << " " << j;
        }
      }
    }
  }
}

TEST(DrawPicture, AreasAreInSideViewsAndSvgs) {
  PictureOptions options;
  options.view = PictureView::kSide;
  const WorldMaker maker = MakerWithArea(0.0);
  EXPECT_TRUE(DrawPicture(maker.world, maker.state, {}, options).ok());
  options.view = PictureView::kTop;
  options.format = PictureFormat::kSvg;
  EXPECT_THAT(test::ValueOf(DrawPicture(maker.world, maker.state, {}, options)), HasSubstr("<image"));
}

TEST(DrawPicture, AnAreaOfManyPixelsHasTheirMeanOnThePage) {
  Bitmap bitmap(4000, 4000);
  for (int y = 0; y < 4000; ++y) {
    for (int x = y % 2; x < 4000; x += 2) bitmap.set_occupied(x, y, true);
  }
  const PixelLines lines{.factor = 0.05};
  const PixelArea area(std::make_shared<const DenseCover>(std::move(bitmap)), lines, lines);
  const Viewport viewport = MakeViewport({0.0, 0.0, 200.0, 200.0}, {});
  const PixelMask mask = MakePixelMask(area, {}, viewport);
  EXPECT_LE(mask.coverage.size(), 4'000'000u);
  EXPECT_FALSE(mask.sharp);
  EXPECT_NEAR(mask.coverage[mask.coverage.size() / 2 + 77], 127, 45);
}

}  // namespace
}  // namespace troupe
