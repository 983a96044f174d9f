#include "common/base/instructions.h"

namespace troupe {

Instructions KnownInstructions() {
#ifdef TROUPE_HAS_AVX512
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq")) return Instructions::kAvx512;
  if (__builtin_cpu_supports("avx2")) return Instructions::kAvx2;
#endif
  return Instructions::kAny;
}

}  // namespace troupe
