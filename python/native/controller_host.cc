// The library python_controllers.so: runs controllers that are classes in Python. A process opens it for the first
// robot with such a controller (robot-agent/controller); all robots of the process share one interpreter, that of the
// process if it is Python's own.
//
// Nothing of Python may escape: what a controller raises arrives as a std::exception, with the line of the user's file.
#include <dlfcn.h>
#include <pybind11/embed.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "python/native/convert.h"
#include "troupe/controller.h"

namespace troupe::python {
namespace {

// Places of an exception in the user's file and its text, by troupe/_host.py.
std::string Describe(const py::error_already_set& error, const std::string& file) {
  try {
    const py::object value = error.value() ? py::object(error.value()) : py::none();
    return py::module_::import("troupe._host").attr("describe")(value, error.trace(), file).cast<std::string>();
  } catch (const std::exception& failure) {
    return std::string("an exception without a text: ") + failure.what();
  }
}

// Calls function() with the interpreter's lock.
template <typename Function>
auto CallPython(const std::string& file, const Function& function) {
  const py::gil_scoped_acquire acquire;
  try {
    return function();
  } catch (const py::error_already_set& error) {
    throw std::runtime_error(Describe(error, file));
  } catch (const py::builtin_exception& error) {
    throw std::runtime_error(error.what());
  }
}

class PythonController final : public Controller {
 public:
  PythonController(py::object instance, std::string file)
      : file_(std::move(file)), instance_(std::move(instance)), update_(instance_.attr("update")) {}

  // Without memory for the state of a thread Python ends the process by itself.
  ~PythonController() override {    // NOLINT(bugprone-exception-escape)
    if (Py_IsInitialized() == 0) {  // the interpreter has ended with the process
      (void)instance_.release();
      (void)update_.release();
      return;
    }
    const py::gil_scoped_acquire acquire;
    update_ = py::object();
    instance_ = py::object();
  }
  PythonController(const PythonController&) = delete;
  PythonController& operator=(const PythonController&) = delete;

  std::vector<std::size_t> Subscriptions() const override {
    return CallPython(file_, [&] {
      std::vector<std::size_t> sensors;
      for (const py::handle sensor : py::iter(Host("subscriptions")(instance_))) {
        sensors.push_back(ToIndex(sensor, "subscriptions"));
      }
      return sensors;
    });
  }

  Command Update(const Observation& observation) override {
    return CallPython(file_, [&] { return ToCommand(update_(ToRecord(observation))); });
  }

  bool AcceptsGoals() const override {
    return CallPython(file_, [&] { return Host("accepts_goals")(instance_).cast<bool>(); });
  }

  std::unique_ptr<Controller> Clone() const override {
    return CallPython(file_, [&] { return std::make_unique<PythonController>(Host("clone")(instance_), file_); });
  }

 private:
  static py::object Host(const char* name) { return py::module_::import("troupe._host").attr(name); }

  std::string file_;
  py::object instance_;
  py::object update_;  // its method
};

std::filesystem::path PackageFolder() {
  Dl_info code{};
  if (dladdr(reinterpret_cast<const void*>(&PackageFolder), &code) == 0) return {};
  std::error_code failure;
  return std::filesystem::canonical(code.dli_fname, failure).parent_path();
}

void CheckPython(const PyStatus& status) {
  if (PyStatus_Exception(status) != 0) {
    throw std::runtime_error(std::string("Python cannot be started: ") + (status.err_msg ? status.err_msg : "?"));
  }
}

// The virtual environment of the user, if it is of this version of Python; else the system's interpreter.
std::string Executable() {
  const char* const environment = std::getenv("VIRTUAL_ENV");
  if (environment != nullptr) {
    const std::filesystem::path folder = environment;
    std::error_code failure;
    const std::string version = "python" + std::to_string(PY_MAJOR_VERSION) + "." + std::to_string(PY_MINOR_VERSION);
    if (std::filesystem::exists(folder / "lib" / version, failure)) return (folder / "bin" / "python3").string();
  }
  return TROUPE_PYTHON;
}

void StartInterpreter() {
  // Extensions, numpy for instance, find Python's functions among the global ones only.
  Dl_info code{};
  if (dladdr(reinterpret_cast<const void*>(&Py_InitializeFromConfig), &code) != 0) {
    dlopen(code.dli_fname, RTLD_NOW | RTLD_GLOBAL | RTLD_NOLOAD);
  }
  PyPreConfig before;
  PyPreConfig_InitPythonConfig(&before);
  before.configure_locale = 0;  // the process keeps its own
  before.utf8_mode = 1;
  CheckPython(Py_PreInitialize(&before));
  PyConfig config;
  PyConfig_InitPythonConfig(&config);
  config.install_signal_handlers = 0;  // Ctrl-C is the program's
  config.parse_argv = 0;
  config.write_bytecode = 0;  // many processes may read one file
  // The order of sets is then the same in every process.
  config.use_hash_seed = 1;
  // Sets and dicts of texts are ordered by their hashes, which are random by default: a controller must not depend on
  // it.
  config.hash_seed = 0;
  PyStatus status = PyConfig_SetBytesString(&config, &config.executable, Executable().c_str());
  if (PyStatus_Exception(status) == 0) status = Py_InitializeFromConfig(&config);
  PyConfig_Clear(&config);
  CheckPython(status);
  // Starting has taken the lock; from now on each call acquires it, on whatever thread.
  PyEval_SaveThread();
}

void StartOnce() {
  static std::mutex starting;
  const std::lock_guard lock(starting);
  if (Py_IsInitialized() == 0) StartInterpreter();
  const py::gil_scoped_acquire acquire;
  py::list path = py::module_::import("sys").attr("path");
  const std::string folder = PackageFolder().parent_path().string();
  if (!path.contains(folder)) path.append(folder);
}

Controller* Create(const RobotInfo& info, const std::string& file) {
  StartOnce();
  return CallPython(file, [&] {
    const std::string& name = info.robot->controller.name;
    const std::string type = name.substr(name.rfind(':') + 1);
    py::object instance = py::module_::import("troupe._host").attr("make")(file, type, ToRecord(info));
    return new PythonController(std::move(instance), file);
  });
}

}  // namespace
}  // namespace troupe::python

extern "C" __attribute__((visibility("default"))) int troupe_python_controller_abi() {
  return TROUPE_CONTROLLER_ABI;
}

extern "C" __attribute__((visibility("default"))) troupe::Controller* troupe_create_python_controller(
    const troupe::RobotInfo& info, const char* file) {
  return troupe::python::Create(info, file);
}
