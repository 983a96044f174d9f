// The values in XML elements of SDF and URDF; a wrong one is an error with its place.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "common/geometry/limits.h"
#include "worldfile/gazebo/transform3.h"
#include "worldfile/text/xml_reader.h"

namespace troupe {

// Reads values of one file; after an error of the diagnostics values are defaults, so that callers need not check each.
class XmlValues {
 public:
  XmlValues(std::string file, Diagnostics& diagnostics) : file_(std::move(file)), diagnostics_(diagnostics) {}

  const std::string& file() const { return file_; }
  Diagnostics& diagnostics() const { return diagnostics_; }
  SourceLocation At(const XmlElement& element) const { return XmlPlace(element, file_); }
  void Fail(const XmlElement& element, const std::string& message) const { diagnostics_.Fail(At(element), message); }
  void Warn(const XmlElement& element, const std::string& message) const { diagnostics_.Warn(At(element), message); }

  // The numbers of a text at a place; an error if there are not `count` of them, each finite and within `most`.
  std::vector<double> Numbers(std::string_view text, const SourceLocation& where, const std::string& what,
                              std::size_t count, double most = kMaxMagnitude) const;
  // Of the element's text; `otherwise` for an empty text, as SDF has it.
  std::vector<double> Numbers(const XmlElement& element, const std::vector<double>& otherwise,
                              double most = kMaxMagnitude) const;
  // The number in a child; `otherwise` without one. "1e16" and "inf" are cut to `most`: SDF writes them for no limit.
  double Number(const XmlElement& parent, std::string_view child, double otherwise, double most = kMaxMagnitude) const;
  // The same for the first of several names that is there.
  double FirstNumber(const XmlElement& parent, std::initializer_list<std::string_view> names, double otherwise) const;
  // "true", "1" or another text.
  static bool Flag(const XmlElement& parent, std::string_view child, bool otherwise);
  static std::string Text(const XmlElement& parent, std::string_view child, const std::string& otherwise = "");
  static std::string Attribute(const XmlElement& element, std::string_view name, const std::string& otherwise = "");

  // A length above 0 in a child or an attribute.
  double Size(const XmlElement& parent, std::string_view child, double otherwise) const;

  // A `pose` of SDF: x y z roll pitch yaw, or with a quaternion.
  Transform3 Pose(const XmlElement& pose) const;
  // An `origin` of URDF: attributes xyz and rpy.
  Transform3 Origin(const XmlElement& parent) const;
  // The numbers of an attribute; `otherwise` without it.
  std::vector<double> AttributeNumbers(const XmlElement& element, std::string_view name,
                                       const std::vector<double>& otherwise) const;
  // The number of an attribute, cut to kMaxMagnitude as that of a child: URDF has such limits of joints, too.
  double AttributeNumber(const XmlElement& element, std::string_view name, double otherwise) const;

 private:
  std::string file_;
  Diagnostics& diagnostics_;
};

}  // namespace troupe
