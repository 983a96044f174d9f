#include "common/worldfile/build/types/built_in_types.h"

namespace troupe {

ModelType PlainModelType() {
  return {.name = "model"};
}

}  // namespace troupe
