#include "common/sensing/camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "common/base/check.h"
#include "common/base/deterministic_math.h"
#include "common/base/hexadecimal.h"
#include "common/sensing/fan_marks.h"
#include "common/sensing/model_pose.h"
#include "common/sensing/reading_json.h"
#include "common/spatial/column_cast.h"

namespace troupe {
namespace {

using Rgb = std::array<std::uint8_t, 3>;

constexpr Rgb kSky{214, 225, 236};
constexpr Rgb kGroundColor{196, 194, 188};
constexpr double kTopLight = 1.0;
constexpr double kUndersideLight = 0.45;

double Tangent(double angle) {
  const SinCosResult at = SinCos(angle);
  return at.sin / at.cos;
}

std::uint8_t Byte(double value) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 1.0) * 255.0));
}

Rgb Lit(const Color& color, double light) {
  return {Byte(color.r * light), Byte(color.g * light), Byte(color.b * light)};
}

// Sides are lit from the south-west, so that neighbouring walls differ.
double LightOn(const ColumnHit& hit) {
  switch (hit.face) {
    case PrismFace::kTop:
      return kTopLight;
    case PrismFace::kUnderside:
      return kUndersideLight;
    case PrismFace::kSide:
    case PrismFace::kInside:
      break;
  }
  return 0.74 - 0.10 * hit.normal.x() - 0.16 * hit.normal.y();
}

// The optics: the slopes of the rays of the image's columns and rows, per m of depth.
class Optics {
 public:
  // `tilt`: rad, upwards, added to the elevation.
  Optics(const CameraParameters& parameters, double tilt)
      : width_(parameters.width),
        height_(parameters.height),
        side_(Tangent(0.5 * parameters.fov)),
        low_(Tangent(parameters.elevation.min + tilt)),
        high_(Tangent(parameters.elevation.max + tilt)) {}

  // To the left.
  double Aside(std::uint32_t column) const { return side_ * (1.0 - 2.0 * (column + 0.5) / width_); }
  // Upwards.
  double Up(std::uint32_t row) const { return high_ - (high_ - low_) * ((row + 0.5) / height_); }
  // The row, with its fraction, whose middle has this slope: the inverse of Up.
  double RowAt(double up) const { return (high_ - up) / (high_ - low_) * height_ - 0.5; }

  double focal_length_x() const { return 0.5 * width_ / side_; }
  double focal_length_y() const { return height_ / (high_ - low_); }
  double center_x() const { return 0.5 * width_; }
  double center_y() const { return height_ * high_ / (high_ - low_); }

 private:
  double width_;
  double height_;
  double side_;  // tangents of the edges
  double low_;
  double high_;
};

// One column of the image while it is being filled.
class Column {
 public:
  explicit Column(std::uint32_t height) : hits_(height) {}

  // `stretch`: m of horizontal distance for each m of depth. `reach`: m, horizontally.
  void Fill(const Optics& optics, double z, double stretch, double reach, const std::vector<ColumnCut>& cuts) {
    stretch_ = stretch;
    const auto rows = static_cast<std::uint32_t>(hits_.size());
    for (std::uint32_t row = 0; row < rows; ++row) {
      Pixel& pixel = hits_[row];
      pixel.slope = optics.Up(row) / stretch;
      const double ground = pixel.slope < 0.0 && z > 0.0 ? -z / pixel.slope : reach + 1.0;
      pixel.shows_ground = ground <= reach;
      pixel.hit = {std::min(ground, reach), {}, PrismFace::kTop, {0.0, 0.0}};
      pixel.shows_body = false;
    }
    for (const ColumnCut& cut : cuts) {
      const Interval rise{cut.z.min - z, cut.z.max - z};
      std::uint32_t first = 0;
      std::uint32_t end = rows;
      if (cut.enter > 0.0) {
        // The rows from the highest to the lowest slope of the cut's corners, and one more for rounding.
        const double high = std::max(rise.max / cut.enter, rise.max / cut.leave) * stretch;
        const double low = std::min(rise.min / cut.enter, rise.min / cut.leave) * stretch;
        first = Clamped(std::floor(optics.RowAt(high)) - 1.0, rows);
        end = Clamped(std::ceil(optics.RowAt(low)) + 2.0, rows);
      }
      for (std::uint32_t row = first; row < end; ++row) Update(hits_[row], z, cut);
    }
  }

  struct Pixel {
    double slope = 0.0;
    ColumnHit hit = {};  // `model` only if it shows a body
    bool shows_body = false;
    bool shows_ground = false;
  };
  const Pixel& pixel(std::uint32_t row) const { return hits_[row]; }
  double Depth(const Pixel& pixel) const { return pixel.hit.distance / stretch_; }

 private:
  static std::uint32_t Clamped(double row, std::uint32_t rows) {
    return static_cast<std::uint32_t>(std::clamp(row, 0.0, static_cast<double>(rows)));
  }

  static void Update(Pixel& pixel, double z, const ColumnCut& cut) {
    if (cut.enter > pixel.hit.distance) return;
    const std::optional<ColumnHit> hit = HitOf({z, pixel.slope}, cut);
    if (!hit || hit->distance > pixel.hit.distance) return;
    // At the same distance a body comes before the ground, and of bodies the lowest model id.
    if (hit->distance == pixel.hit.distance && pixel.shows_body && pixel.hit.model < hit->model) return;
    pixel.hit = *hit;
    pixel.shows_body = true;
    pixel.shows_ground = false;
  }

  std::vector<Pixel> hits_;
  double stretch_ = 1.0;
};

class Camera final : public Sensor {
 public:
  explicit Camera(const SensorMount& mount) : Sensor(mount), optics_(parameters(), 0.0) {
    const std::span<const SensorPlace> cameras = mount.scene.cameras();
    const auto place = std::lower_bound(cameras.begin(), cameras.end(), SensorPlace{mount.robot, mount.index});
    TROUPE_CHECK(place != cameras.end());
    row_ = static_cast<std::size_t>(place - cameras.begin());
  }

  // A depth that is no number within the limits is null.
  std::string JsonLines(const WorldDescription& world, const SensorReading& reading) const override {
    const CameraReading& content = std::get<CameraReading>(reading.content);
    std::string line = LineStart(reading.tick, world.robot(robot()).name, description().name) +
                       ",\"width\":" + std::to_string(content.width) + ",\"height\":" + std::to_string(content.height) +
                       ",\"depths\":[";
    for (const float depth : content.depths) {
      if (line.back() != '[') line += ',';
      line += std::isfinite(depth) ? JsonNumber(depth) : "null";
    }
    return line + "],\"colors\":\"" + ToHexadecimal(std::as_bytes(std::span(content.colors))) + "\"}\n";
  }

  void AddMarks(const SensedWorld& world, const SensorReading& reading, std::vector<Mark>& marks) const override {
    const CameraReading& content = std::get<CameraReading>(reading.content);
    const Transform2 transform(world.bodies.X_WB(world.scene.body_of(robot())) * content.X_RS);
    const double side = content.limits.max * optics_.Aside(0);
    const double z = world.bodies.X_WB(world.scene.body_of(robot())).z + content.X_RS.z;
    marks.push_back({MarkShape::kArea,
                     MarkRole::kReach,
                     z,
                     {transform * Vec2(0.0, 0.0), transform * Vec2(content.limits.max, -side),
                      transform * Vec2(content.limits.max, side)}});
  }

 private:
  const CameraParameters& parameters() const { return std::get<CameraParameters>(description().parameters); }

  void MeasureInto(const SensedWorld& world, Tick tick, SensorReading& reading) const override {
    const std::uint32_t width = parameters().width;
    const std::uint32_t height = parameters().height;
    reading.tick = tick;
    const CameraState turned = world.state != nullptr ? world.state->cameras[row_] : CameraState();
    const Optics optics = turned.tilt == 0.0 ? optics_ : Optics(parameters(), turned.tilt);
    const Pose X_MS = parameters().X_MS * Pose{0.0, 0.0, 0.0, turned.pan};
    CameraReading& content = ContentOf<CameraReading>(reading);
    content.X_RS = MountAt(world) * X_MS;
    content.width = width;
    content.height = height;
    content.focal_length_x = optics.focal_length_x();
    content.focal_length_y = optics.focal_length_y();
    content.center_x = optics.center_x();
    content.center_y = optics.center_y();
    content.limits = parameters().range;
    const std::size_t pixels = std::size_t{width} * height;
    content.colors.resize(3 * pixels);
    content.depths.resize(pixels);
    content.models.resize(pixels);

    const Pose X_WS = world.bodies.X_WM(description().model) * X_MS;
    const Transform2 to_world(X_WS);
    const double widest = std::sqrt(1.0 + optics.Aside(0) * optics.Aside(0));
    ColumnCaster caster(world.scene, world.bodies, X_WS.translation(), parameters().range.max * widest, robot(),
                        Sight::kBodies);
    Column column(height);
    std::vector<ColumnCut> cuts;
    for (std::uint32_t x = 0; x < width; ++x) {
      const double aside = optics.Aside(x);
      const double stretch = std::sqrt(1.0 + aside * aside);
      const double reach = parameters().range.max * stretch;
      const ZRange seen{X_WS.z + std::min(0.0, parameters().range.max * optics.Up(height - 1)),
                        X_WS.z + std::max(0.0, parameters().range.max * optics.Up(0))};
      caster.Cut(to_world.Rotate(Vec2(1.0, aside) / stretch), seen, cuts);
      column.Fill(optics, X_WS.z, stretch, reach, cuts);
      Shade shade;
      for (std::uint32_t y = 0; y < height; ++y) {
        WritePixel(world, tick, column, column.pixel(y), std::size_t{y} * width + x, shade, content);
      }
    }
  }

  // The colour of a face. Most pixels of a column show the face of the pixel before.
  struct Shade {
    std::optional<ColumnHit> hit = {};
    Rgb rgb = {};
  };

  const Rgb& ColorOf(const SensedWorld& world, Tick tick, const ColumnHit& hit, Shade& shade) const {
    const bool is_same =
        shade.hit && shade.hit->model == hit.model && shade.hit->face == hit.face && shade.hit->normal == hit.normal;
    if (!is_same) shade = {hit, Lit(ColorOfModel(world, hit.model, tick), LightOn(hit))};
    return shade.rgb;
  }

  void WritePixel(const SensedWorld& world, Tick tick, const Column& column, const Column::Pixel& pixel,
                  std::size_t place, Shade& shade, CameraReading& content) const {
    Rgb rgb = kSky;
    std::int32_t model = CameraReading::kNothing;
    float depth = std::numeric_limits<float>::infinity();
    if (pixel.shows_body || pixel.shows_ground) {
      const double ahead = column.Depth(pixel);
      depth = ahead < parameters().range.min ? -std::numeric_limits<float>::infinity() : static_cast<float>(ahead);
      rgb = kGroundColor;
      model = CameraReading::kGround;
      if (pixel.shows_body) {
        rgb = ColorOf(world, tick, pixel.hit, shade);
        model = static_cast<std::int32_t>(pixel.hit.model.index());
      }
    }
    std::copy(rgb.begin(), rgb.end(), content.colors.begin() + static_cast<std::ptrdiff_t>(3 * place));
    content.depths[place] = depth;
    content.models[place] = model;
  }

  Optics optics_;        // without a tilt
  std::size_t row_ = 0;  // of CameraState
};

}  // namespace

std::unique_ptr<const Sensor> MakeCamera(const SensorMount& mount) {
  return std::make_unique<Camera>(mount);
}

}  // namespace troupe
