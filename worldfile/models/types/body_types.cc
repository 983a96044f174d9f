#include "worldfile/models/types/built_in_types.h"

namespace troupe {

ModelType PlainModelType() {
  return {.name = "model"};
}

}  // namespace troupe
