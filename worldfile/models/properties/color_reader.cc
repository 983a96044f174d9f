#include "worldfile/models/properties/color_reader.h"

#include <algorithm>

#include "troupe/random.h"
#include "worldfile/models/properties/color_names.h"
#include "worldfile/text/quote.h"

namespace troupe {
namespace {

Color RandomColor(std::uint64_t seed, ModelId model) {
  constexpr std::uint64_t kStream = 0x636f6c6f72;  // "color"
  const auto draw = [&](std::uint64_t channel) {
    return RandomUniform({seed, kStream, std::uint64_t{model.index()}, channel});
  };
  return {draw(0), draw(1), draw(2), 1.0};
}

Color ColorOfName(PropertyReader& reader, const std::string& name) {
  if (const std::optional<Color> color = FindColor(name)) return *color;
  reader.diagnostics().Warn(reader.Where("color"), "colour " + Quoted(name) + " is not known; red is used");
  return {};
}

}  // namespace

Color ReadColor(PropertyReader& reader, const Color& otherwise, std::uint64_t seed, ModelId model) {
  if (reader.node().Find("color") != nullptr) {
    const std::string name = reader.Text("color", "red");
    const Color color = name == "random" ? RandomColor(seed, model) : ColorOfName(reader, name);
    if (const Property* unused = reader.Use("color_rgba")) {
      reader.diagnostics().Warn(unused->where, "property 'color_rgba' has no effect beside 'color'");
    }
    return color;
  }
  const auto rgba = reader.Numbers("color_rgba", 4);
  if (!rgba) return otherwise;
  const std::vector<double>& c = *rgba;
  if (*std::min_element(c.begin(), c.end()) < 0.0 || *std::max_element(c.begin(), c.end()) > 1.0) {
    reader.diagnostics().Warn(reader.Where("color_rgba"), "found a colour beyond 0 to 1; it is clamped");
  }
  const auto clamp = [](double value) { return std::clamp(value, 0.0, 1.0); };
  return {clamp(c[0]), clamp(c[1]), clamp(c[2]), clamp(c[3])};
}

}  // namespace troupe
