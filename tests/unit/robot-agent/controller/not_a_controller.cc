// A shared library without a controller.
extern "C" int something_else() {
  return 1;
}
