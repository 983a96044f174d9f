// Properties that sensors of several kinds have in common. Private to this folder.
#pragma once

#include <string>
#include <string_view>

#include "worldfile/models/types/model_type.h"

namespace troupe {

// "90 degrees", or "1.5 radians" in a file with those.
std::string AngleText(const Units& units, double radians);

// A side of the image of property `name`, in pixels, within the limits.
std::uint32_t ImageSide(PropertyReader& reader, const std::string& name, double found);

// `update_interval`, in ticks.
std::uint32_t ReadPeriod(PropertyReader& reader, std::int64_t interval_ns);

// `fov`, in rad, from 0 to 2 pi.
double ReadFov(PropertyReader& reader, double otherwise);

// `range [min max]`, in m.
Interval ReadRange(PropertyReader& reader, const Interval& otherwise);

// A length of at least 0, in m.
double ReadDistance(PropertyReader& reader, const std::string& name, double otherwise);

// An angle in rad, its size at most `max` rad.
double ReadAngle(PropertyReader& reader, const std::string& name, double otherwise, double max = 2.0 * kPi);

// Adds the sensor that the draft's model is to its robot; a sensor on no robot gets a warning that names it `noun`.
// Parameters that are out of bounds are an error at the model.
void AddSensor(PropertyReader& reader, const ModelDraft& draft, std::string_view noun, SensorParameters parameters,
               BuildContext& context);

}  // namespace troupe
