#include "troupe/parameters.h"

#include "common/base/json_reader.h"

namespace troupe {

Parameters::Parameters(std::string place, const std::string& text)
    : reader_(std::make_unique<JsonReader>(JsonReader::OfText(text, std::move(place)))) {
  if (!reader_->node().is_object()) reader_->Fail("an object");
}

Parameters::~Parameters() = default;

std::optional<double> Parameters::ReadNumber(const char* key, const Interval& allowed) {
  return reader_->Number(key, allowed.min, allowed.max);
}

std::optional<double> Parameters::ReadNumberOrName(const char* key, const Interval& allowed,
                                                   const std::vector<NamedNumber>& names) {
  std::vector<JsonReader::NamedNumber> read;
  for (const NamedNumber& named : names) read.push_back({named.name, named.value});
  return reader_->Number(key, allowed.min, allowed.max, read);
}

std::optional<bool> Parameters::ReadBool(const char* key) {
  return reader_->Optional<bool>(key);
}

std::optional<std::string> Parameters::ReadText(const char* key) {
  return reader_->Optional<std::string>(key);
}

void Parameters::Fail(const std::string& message) {
  reader_->FailWith(message);
}

Status Parameters::status() const {
  return reader_->status();
}

Status Parameters::Finish() {
  return reader_->Finish();
}

}  // namespace troupe
