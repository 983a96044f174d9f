// The camera, column by column. The image plane is vertical, so that the pixels of a column lie in one vertical half
// plane; bodies are prisms, so that each cuts the half plane in a rectangle (ColumnCut). A pixel is then the first
// rectangle that its ray meets: exact, without a depth buffer of triangles, and the cost goes with columns times bodies
// in sight plus pixels.
//
// Depth is measured along the optical axis, as a pinhole camera does it, not along the ray; `stretch` is the ratio of
// horizontal distance to depth in a column. A camera that looks up or down has a shifted lens (low_ and high_ are
// tangents of elevations), so that upright edges stay upright.
//
// Colours have a fixed light and no shadows: the image serves recognition by colour and people's eyes, not photometry.
// All steps use deterministic functions, so that images are equal on all machines.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "common/base/text.h"
#include "common/sensing/sensor.h"
#include "common/sensing/sensor_kinds.h"
#include "common/spatial/column_cast.h"
#include "troupe/check.h"
#include "troupe/deterministic_math.h"

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
double LightOn(PrismFace face, const Vec2& normal) {
  switch (face) {
    case PrismFace::kTop:
      return kTopLight;
    case PrismFace::kUnderside:
      return kUndersideLight;
    case PrismFace::kSide:
    case PrismFace::kInside:
      break;
  }
  return 0.74 - 0.10 * normal.x() - 0.16 * normal.y();
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
  explicit Column(const Optics& optics, std::uint32_t height)
      : optics_(optics), ups_(height), slopes_(height), distances_(height), surfaces_(height) {
    for (std::uint32_t row = 0; row < height; ++row) ups_[row] = optics.Up(row);
  }

  // The surface that a pixel shows: a face of one of the cuts, the ground or nothing.
  class Surface {
   public:
    static constexpr Surface Nothing() { return Surface(0); }
    static constexpr Surface Ground() { return Surface(1); }
    static constexpr Surface Face(std::size_t cut, PrismFace face) {
      return Surface(static_cast<std::uint32_t>(2 + 4 * cut) + static_cast<std::uint32_t>(face));
    }
    constexpr Surface() = default;

    bool is_face() const { return number_ >= 2; }
    std::size_t cut() const { return (number_ - 2) / 4; }
    PrismFace face() const { return static_cast<PrismFace>((number_ - 2) % 4); }
    bool operator==(const Surface&) const = default;

   private:
    explicit constexpr Surface(std::uint32_t number) : number_(number) {}
    std::uint32_t number_ = 0;
  };

  // `stretch`: m of horizontal distance for each m of depth. `reach`: m, horizontally.
  void Fill(double z, double stretch, double reach, std::span<const ColumnCut> cuts) {
    stretch_ = stretch;
    FillWithGround(z, reach);
    for (std::size_t i = 0; i < cuts.size(); ++i) {
      const ColumnCut& cut = cuts[i];
      const Interval rise{cut.z.min - z, cut.z.max - z};
      std::size_t first = 0;
      std::size_t end = ups_.size();
      // Else the camera is inside of the cut's extent, and every row may see it.
      if (cut.enter > 0.0) {
        // The rows from the highest to the lowest slope of the cut's corners, and one more for rounding.
        const double high = std::max(rise.max / cut.enter, rise.max / cut.leave) * stretch;
        const double low = std::min(rise.min / cut.enter, rise.min / cut.leave) * stretch;
        first = Clamped(std::floor(optics_.RowAt(high)) - 1.0);
        end = Clamped(std::ceil(optics_.RowAt(low)) + 2.0);
      }
      for (std::size_t row = first; row < end; ++row) Update(row, z, i, cuts);
    }
  }

  Surface surface(std::size_t row) const { return surfaces_[row]; }
  double depth(std::size_t row) const { return distances_[row] / stretch_; }

 private:
  std::size_t Clamped(double row) const {
    return static_cast<std::size_t>(std::clamp(row, 0.0, static_cast<double>(ups_.size())));
  }

  void FillWithGround(double z, double reach) {
    for (std::size_t row = 0; row < ups_.size(); ++row) {
      const double slope = ups_[row] / stretch_;
      // A camera at or below the ground sees none of it.
      const double ground = slope < 0.0 && z > 0.0 ? -z / slope : reach + 1.0;
      slopes_[row] = slope;
      distances_[row] = std::min(ground, reach);
      surfaces_[row] = ground <= reach ? Surface::Ground() : Surface::Nothing();
    }
  }

  void Update(std::size_t row, double z, std::size_t i, std::span<const ColumnCut> cuts) {
    const ColumnCut& cut = cuts[i];
    if (cut.enter > distances_[row]) return;
    const std::optional<CutHit> hit = HitOf({z, slopes_[row]}, cut);
    if (!hit || hit->distance > distances_[row]) return;
    // At the same distance a body comes before the ground, and of bodies the lowest model id.
    const Surface shown = surfaces_[row];
    if (hit->distance == distances_[row] && shown.is_face() && cuts[shown.cut()].model < cut.model) return;
    distances_[row] = hit->distance;
    surfaces_[row] = Surface::Face(i, hit->face);
  }

  const Optics& optics_;
  double stretch_ = 1.0;
  // The values of each row: the rise per m of depth and of horizontal distance; m, horizontally; and the surface at
  // that distance.
  std::vector<double> ups_;
  std::vector<double> slopes_;
  std::vector<double> distances_;
  std::vector<Surface> surfaces_;
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
    std::string line;
    JsonWriter json(line);
    BeginReading(json, reading.tick, world.robot(robot()).name, description().name);
    json.Member("width", content.width).Member("height", content.height).Key("depths").BeginList();
    for (const float depth : content.depths) json.Value(double{depth});
    json.EndList().Member("colors", ToHexadecimal(std::as_bytes(std::span(content.colors)))).EndObject();
    return line + "\n";
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
    // Pan and tilt are state: a controller turns the camera from tick to tick.
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
    // The caster's radius covers the corners of the image, whose rays are longest.
    const double widest = std::sqrt(1.0 + optics.Aside(0) * optics.Aside(0));
    ColumnCaster caster(world.scene, world.bodies, X_WS.translation(), parameters().range.max * widest, robot(),
                        Sight::kBodies);
    Column column(optics, height);
    std::vector<ColumnCut> cuts;
    for (std::uint32_t x = 0; x < width; ++x) {
      const double aside = optics.Aside(x);
      const double stretch = std::sqrt(1.0 + aside * aside);
      const double reach = parameters().range.max * stretch;
      const ZRange seen{X_WS.z + std::min(0.0, parameters().range.max * optics.Up(height - 1)),
                        X_WS.z + std::max(0.0, parameters().range.max * optics.Up(0))};
      caster.Cut(to_world.Rotate(Vec2(1.0, aside) / stretch), seen, cuts);
      column.Fill(X_WS.z, stretch, reach, cuts);
      WriteColumn(world, tick, column, cuts, x, content);
    }
  }

  void WriteColumn(const SensedWorld& world, Tick tick, const Column& column, std::span<const ColumnCut> cuts,
                   std::uint32_t x, CameraReading& content) const {
    // The colour is computed once for a run of pixels of one surface: neighbours mostly show the same one.
    Rgb rgb = kSky;
    std::int32_t model = CameraReading::kNothing;
    Column::Surface shown = Column::Surface::Nothing();
    for (std::uint32_t y = 0; y < content.height; ++y) {
      const Column::Surface surface = column.surface(y);
      if (surface != shown) {
        shown = surface;
        if (surface.is_face()) {
          const ColumnCut& cut = cuts[surface.cut()];
          rgb = Lit(ColorOfModel(world, cut.model, tick), LightOn(surface.face(), cut.normal));
          model = static_cast<std::int32_t>(cut.model.index());
        } else {
          const bool is_ground = surface == Column::Surface::Ground();
          rgb = is_ground ? kGroundColor : kSky;
          model = is_ground ? CameraReading::kGround : CameraReading::kNothing;
        }
      }
      const double depth = column.depth(y);
      const std::size_t place = std::size_t{y} * content.width + x;
      std::copy(rgb.begin(), rgb.end(), content.colors.begin() + static_cast<std::ptrdiff_t>(3 * place));
      content.depths[place] = surface == Column::Surface::Nothing() ? std::numeric_limits<float>::infinity()
                              : depth < parameters().range.min      ? -std::numeric_limits<float>::infinity()
                                                                    : static_cast<float>(depth);
      content.models[place] = model;
    }
  }

  Optics optics_;        // without a tilt
  std::size_t row_ = 0;  // of CameraState
};

}  // namespace

std::unique_ptr<const Sensor> MakeCamera(const SensorMount& mount) {
  return std::make_unique<Camera>(mount);
}

}  // namespace troupe
