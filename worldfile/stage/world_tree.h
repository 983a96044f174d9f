// WorldTree: the content of a world file after includes and defines, before anything is given a meaning. Stage files,
// ROS maps, buildings and scenarios all become trees, so that a scenario can override any property before the world is
// built (build_world.h).
//
// Everything is text and numbers in the file's units (UnitsOf), but for the doors and lifts of buildings, which are
// drafts (part_draft.h); no property is known here, an unknown one is found by the builder. Every value keeps its place
// in its file: an override of line 3 of a scenario is reported there, not in the world file.
//
// The order of children is the order of the file and becomes the order of models, and with it of ids, names such as
// "position:2" and random draws: it must not depend on containers or addresses. Names of one property are unique in a
// node.
#pragma once

#include <cstddef>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "troupe/result.h"
#include "worldfile/stage/part_draft.h"

namespace troupe {

struct Site;         // worldfile/sites/site.h
struct GridProblem;  // worldfile/grids/grid_problem.h

// A number, with its text for messages.
struct NumberValue {
  double value = 0.0;
  std::string text;
};

// A number, a string, or a tuple of them.
struct Value {
  using Number = NumberValue;
  using Scalar = std::variant<Number, std::string>;
  using Tuple = std::vector<Scalar>;

  std::variant<Number, std::string, Tuple> content;
  SourceLocation where;
};

struct Property {
  std::string name;  // "pose", "point[0]"
  Value value;
  SourceLocation where;
};

struct WorldNode;

// The children of a node, in their order. Nodes that are made from one macro share its children: 100,000 robots with
// twelve rays each would be millions of nodes otherwise. A child that is changed becomes one of its node alone.
class ChildNodes {
 public:
  class Iterator {
   public:
    using iterator_category = std::forward_iterator_tag;
    using value_type = WorldNode;
    using difference_type = std::ptrdiff_t;
    using pointer = const WorldNode*;
    using reference = const WorldNode&;

    Iterator() = default;
    explicit Iterator(std::vector<std::shared_ptr<WorldNode>>::const_iterator at) : at_(at) {}
    reference operator*() const { return **at_; }
    pointer operator->() const { return at_->get(); }
    Iterator& operator++() {
      ++at_;
      return *this;
    }
    Iterator operator++(int) { return Iterator(at_++); }
    bool operator==(const Iterator&) const = default;

   private:
    std::vector<std::shared_ptr<WorldNode>>::const_iterator at_;
  };

  Iterator begin() const { return Iterator(nodes_.begin()); }
  Iterator end() const { return Iterator(nodes_.end()); }
  std::size_t size() const { return nodes_.size(); }
  bool empty() const { return nodes_.empty(); }
  const WorldNode& operator[](std::size_t i) const { return *nodes_[i]; }
  const WorldNode& front() const { return *nodes_.front(); }
  const WorldNode& back() const { return *nodes_.back(); }

  // The child for changes: a copy of its own if it is shared.
  WorldNode& Change(std::size_t i);
  void Add(WorldNode node);
  void Add(const ChildNodes& shared) { nodes_.insert(nodes_.end(), shared.nodes_.begin(), shared.nodes_.end()); }
  // Only the children whose indices, in ascending order, these are.
  ChildNodes Selected(const std::vector<std::size_t>& indices) const;

 private:
  std::vector<std::shared_ptr<WorldNode>> nodes_;
};

// A model, a sensor, a block, or (the root) the world. Defines are already applied: the macro's properties and children
// precede the instance's own; of two properties with one name the later one counts.
struct WorldNode {
  std::string type;                  // the base type: "position", "sensor", "block", ...
  std::vector<std::string> macros;   // names of the defines it was made from, outermost first
  std::vector<Property> properties;  // names are unique
  ChildNodes children;
  SourceLocation where;
  std::shared_ptr<const PartDraft> draft = {};  // of a model from another format; null for other nodes

  const Property* Find(std::string_view name) const;
  // The content of a property that is a Value::Number, a std::string or a Value::Tuple. Null: the node has none of that
  // name and kind.
  template <typename Content>
  const Content* FindContent(std::string_view name) const {
    const Property* const property = Find(name);
    return property != nullptr ? std::get_if<Content>(&property->value.content) : nullptr;
  }
  // The draft of that kind; a default one if the node has none.
  template <typename Draft>
  Draft DraftOf() const {
    const Draft* const found = draft ? std::get_if<Draft>(draft.get()) : nullptr;
    return found != nullptr ? *found : Draft();
  }
  // Replaces the property of that name, or adds it.
  void Set(Property property);
};

// The last of the properties with one name, at the place of the first.
std::vector<Property> LastOfEachName(std::vector<Property> properties);

// `define NAME BASE ( body )`, not yet applied.
struct Define {
  std::string base;
  std::vector<Property> properties;
  ChildNodes children;  // types may be macros
  SourceLocation where;
  std::shared_ptr<const PartDraft> draft = {};  // of a model from another format; null for other defines
};

struct WorldTree {
  WorldNode world;                        // top-level properties; children are the top-level nodes
  std::map<std::string, Define> defines;  // for making further instances (spawn rules)
  std::vector<std::string> files;         // every file that was read, the top one first
  std::vector<Warning> warnings;
  std::string directory;                         // of the top file: relative bitmaps and includes start here
  std::shared_ptr<const Site> site = {};         // that the tree was made from; null for other files
  std::shared_ptr<const GridProblem> grid = {};  // likewise
};

// The factors from the units of a world's files to metres and radians.
struct FileUnits {
  double metres = 1.0;
  double radians = 1.0;
};
FileUnits UnitsOf(const WorldNode& world);

// True if nodes of this type become models; the others (block, sensor, window) belong to their parent.
bool IsModelType(const std::string& type);

// The names of `parent`'s children in their order, without the parent's: the property "name", or TYPE:N where N counts
// the children of that type before this one. A name that a child before it has is followed by a number. The name of a
// child that is no model is "".
std::vector<std::string> ChildNames(const WorldNode& parent);

// The name that the property "name" gives, or the text of a number; nothing if it has none, or none that can be one.
std::optional<std::string> GivenName(const WorldNode& node);

// Numbers for names that are given again: "a", "a:2", "a:3".
class FreeNames {
 public:
  // The name itself the first time, then the name with a number.
  std::string Add(const std::string& name);

 private:
  std::map<std::string, int> next_;  // by name: the number for the next one
};

// The full name of a child: "parent.child", or, for a name that starts with a slash, the rest of it.
std::string FullName(const std::string& parent_name, const std::string& name);

}  // namespace troupe
