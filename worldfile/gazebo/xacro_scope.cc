#include "worldfile/gazebo/xacro_scope.h"

namespace troupe {
namespace {

std::pair<std::string*, XacroScope*> FindOwn(const std::string& name, XacroScope& space) {
  if (const auto found = space.texts.find(name); found != space.texts.end()) return {&found->second, &space};
  const std::size_t dot = name.find('.');
  const auto inner = dot == std::string::npos ? space.spaces.end() : space.spaces.find(name.substr(0, dot));
  if (inner == space.spaces.end()) return {nullptr, nullptr};
  return FindOwn(name.substr(dot + 1), *inner->second);
}

}  // namespace

XacroScope* SpaceOf(XacroScope& scope) {
  for (XacroScope* at = &scope; at != nullptr; at = at->outer) {
    if (at->space != nullptr) return at->space;
    if (!at->prefix.empty()) return at;
  }
  return nullptr;
}

std::pair<std::string*, XacroScope*> FindProperty(const std::string& name, XacroScope& scope) {
  const std::size_t dot = name.find('.');
  for (XacroScope* at = &scope; at != nullptr; at = at->outer) {
    if (const auto found = at->texts.find(name); found != at->texts.end()) return {&found->second, at};
    if (dot != std::string::npos) {
      const auto space = at->spaces.find(name.substr(0, dot));
      if (space != at->spaces.end()) return FindOwn(name.substr(dot + 1), *space->second);
    }
    if (at->space == nullptr) continue;
    if (const auto own = FindOwn(name, *at->space); own.first != nullptr) return own;
  }
  return {nullptr, nullptr};
}

}  // namespace troupe
