// ModelFiles: the files that worlds and robots of Gazebo and ROS name by URIs: model://, package://, file:// and paths.
//
// Search, for a URI with a name: the folders of GZ_SIM_RESOURCE_PATH (to which --model-path adds), of
// IGN_GAZEBO_RESOURCE_PATH, GAZEBO_MODEL_PATH, GAZEBO_RESOURCE_PATH and ROS_PACKAGE_PATH (separated by colons), the
// folder share of each of AMENT_PREFIX_PATH, then beside the naming file: its folder and the four above it, and the
// folder `models` in each. Models of Fuel (https://) are those that Gazebo has downloaded, else a folder of their name.
// What is read is kept, so that a mesh of a hundred models is read once. The number and bytes of files are limited.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/paths.h"
#include "troupe/result.h"
#include "worldfile/gazebo/mesh.h"
#include "worldfile/text/xml_reader.h"

namespace troupe {

class ModelFiles {
 public:
  explicit ModelFiles(AllowedPaths allowed) : allowed_(std::move(allowed)) {}

  // The file or folder that `uri` names in `naming_file`. The error, at `where`, lists where it was sought.
  Result<std::string> Find(const std::string& uri, const std::string& naming_file, const SourceLocation& where) const;

  // The same, for a model: in a folder the SDF file that its model.config names, with the highest version, or
  // model.sdf.
  Result<std::string> FindModel(const std::string& uri, const std::string& naming_file, const SourceLocation& where);

  // The root of an XML file. `where`: what names it.
  Result<std::shared_ptr<const XmlElement>> ReadXml(const std::string& path, const SourceLocation& where);
  // Another root for the file, such as the one with its macros applied.
  void ReplaceXml(const std::string& path, XmlElement root);

  Result<std::shared_ptr<const TriangleMesh>> ReadMesh(const std::string& path, const SourceLocation& where);

  const AllowedPaths& allowed() const { return allowed_; }
  // All that was read, in the order of the first time.
  const std::vector<std::string>& files() const { return files_; }

 private:
  Result<std::string> FindDownloaded(const std::string& uri, const std::string& naming_file,
                                     const SourceLocation& where) const;
  Result<std::string> ReadText(const std::string& path, const SourceLocation& where);
  bool Exists(const std::string& path) const;

  AllowedPaths allowed_;
  std::map<std::string, std::shared_ptr<const XmlElement>> xml_;
  std::map<std::string, std::shared_ptr<const TriangleMesh>> meshes_;
  std::vector<std::string> files_;
  std::size_t bytes_ = 0;
};

}  // namespace troupe
