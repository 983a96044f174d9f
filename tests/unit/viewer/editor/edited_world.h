// Requests to an editor in a test.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "viewer/editor/editor.h"

namespace troupe {

inline std::unique_ptr<Editor> OpenedEditor(const std::string& path) {
  Result<std::unique_ptr<Editor>> editor = Editor::Open(path);
  EXPECT_TRUE(editor.ok()) << (editor.ok() ? "" : editor.error().ToString());
  return editor.ok() ? std::move(editor).value() : nullptr;
}

inline Result<nlohmann::json> Executed(Editor& editor, const nlohmann::json& request) {
  const Result<EditOperation> operation = DecodeEditOperation(JsonReader::OfText(request.dump()));
  if (!operation.ok()) return operation.error();
  const auto execute = [&](const auto& each) -> Result<nlohmann::json> {
    if constexpr (requires { editor.Execute(each); }) {
      return editor.Execute(each);
    } else {
      return Failure("no operation of an editor alone");
    }
  };
  return std::visit(execute, operation.value());
}

inline nlohmann::json Applied(Editor& editor, const nlohmann::json& request) {
  Result<nlohmann::json> reply = Executed(editor, request);
  EXPECT_TRUE(reply.ok()) << request << ": " << (reply.ok() ? "" : reply.error().ToString());
  return reply.ok() ? std::move(reply).value() : nlohmann::json();
}

// The error; the text stays as it is.
inline std::string Refused(Editor& editor, const nlohmann::json& request) {
  const std::string before = editor.text();
  const Result<nlohmann::json> reply = Executed(editor, request);
  EXPECT_FALSE(reply.ok()) << request;
  EXPECT_EQ(editor.text(), before);
  return reply.ok() ? "" : reply.error().ToString();
}

inline std::string WithPart(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

}  // namespace troupe
