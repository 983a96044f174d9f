// The extension troupe._troupe, on libtroupe.
#include "python/native/world.h"
#include "troupe/version.h"

PYBIND11_MODULE(_troupe, module) {
  module.doc() = "The native part of troupe: its names are those of the package.";
  module.attr("__version__") = troupe::VersionText();
  troupe::python::DefineState(module);
  troupe::python::DefineSimulation(module);
  troupe::python::DefineVectorSimulation(module);
  troupe::python::DefineEpisodes(module);
  troupe::python::DefineMonitors(module);
  troupe::python::DefineRecording(module);
  troupe::python::DefinePixels(module);
  pybind11::module_::import("atexit").attr("register")(pybind11::cpp_function(&troupe::python::AwaitCalls));
}
