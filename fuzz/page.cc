// Feeds any bytes to the reader of the page's requests, those of an editor included.
#include <string>

#include "fuzz/targets.h"
#include "viewer/gateway/page_request.h"

namespace troupe::fuzz {

void PageRequest(Bytes bytes) {
  const Result<troupe::PageRequest> request = ParsePageRequest(TextOf(bytes), kMaxEditRequest);
  if (!request.ok()) return Check(!request.error().message.empty());
  const auto* const edit = std::get_if<PageEdit>(&request.value());
  if (edit != nullptr && !edit->operation.ok()) Check(!edit->operation.error().message.empty());
}

}  // namespace troupe::fuzz
