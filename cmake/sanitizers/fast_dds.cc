// Options of the address sanitizer in programs on Fast DDS. Debian's build of it deletes a part of each reader by a
// type of another size than the allocated one, which is harmless, but which the sanitizer takes for an error of the
// program.
extern "C" const char* __asan_default_options();   // NOLINT(bugprone-reserved-identifier): the sanitizer's name
extern "C" const char* __asan_default_options() {  // NOLINT(bugprone-reserved-identifier)
  return "new_delete_type_mismatch=0";
}
