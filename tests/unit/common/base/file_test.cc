#include "common/base/file.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "common/base/output_file.h"
#include "tests/support/without_memory.h"

namespace troupe {
namespace {

using testing::HasSubstr;

constexpr std::size_t kMaxBytes = 1'000'000;

class FileTest : public testing::Test {
 protected:
  FileTest() {
    std::string pattern = (std::filesystem::temp_directory_path() / "file-test-XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
  }
  ~FileTest() override { std::filesystem::remove_all(folder_); }

  std::string Path(const std::string& name) const { return (folder_ / name).string(); }
  void Write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }
  std::string Read(const std::string& name) const {
    std::ostringstream text;
    text << std::ifstream(folder_ / name).rdbuf();
    return text.str();
  }
  std::size_t FilesInFolder() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder_), {}));
  }
  std::string MakePipe() const {
    EXPECT_EQ(mkfifo(Path("pipe").c_str(), 0600), 0);
    return Path("pipe");
  }
  std::string MakeSocket() const {
    sockaddr_un address = {};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, Path("socket").c_str(), sizeof address.sun_path - 1);
    const FileDescriptor made(socket(AF_UNIX, SOCK_STREAM, 0));
    EXPECT_EQ(bind(made.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    return Path("socket");
  }

  std::filesystem::path folder_;
};

// Files that end at `bytes`, as on a full disk, while the object exists.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int);
};

TEST_F(FileTest, ReadsAWholeFile) {
  const std::string text(300'000, 'x');
  Write("text", text + "end");
  EXPECT_EQ(ReadWholeFile(Path("text"), kMaxBytes).value(), text + "end");
  Write("empty", "");
  EXPECT_EQ(ReadWholeFile(Path("empty"), kMaxBytes).value(), "");
}

TEST_F(FileTest, ReadsAFileWhoseSizeIsSaidToBeZero) {
  const Result<std::string> text = ReadWholeFile("/proc/self/status", kMaxBytes);
  ASSERT_TRUE(text.ok());
  EXPECT_THAT(text.value(), HasSubstr("\nVmRSS:"));
}

TEST_F(FileTest, RefusesALongFile) {
  Write("text", std::string(11, 'x'));
  EXPECT_EQ(ReadWholeFile(Path("text"), 11).value().size(), 11u);
  const Result<std::string> text = ReadWholeFile(Path("text"), 10);
  ASSERT_FALSE(text.ok());
  EXPECT_EQ(text.error().message, "found 11 bytes, expected at most 10");
  EXPECT_THAT(ReadWholeFile("/proc/self/status", 10).error().message, HasSubstr("expected at most 10"));
}

TEST_F(FileTest, ReadsRegularFilesOnlyAndWaitsForNoProgram) {
  const std::pair<std::string, const char*> cases[] = {{folder_.string(), "it is a folder, expected a regular file"},
                                                       {MakePipe(), "it is a named pipe, expected a regular file"},
                                                       {MakeSocket(), "it is a socket, expected a regular file"},
                                                       {"/dev/zero", "it is a device, expected a regular file"}};
  for (const auto& [path, message] : cases) {
    const Result<FileDescriptor> file = OpenToRead(path);
    ASSERT_FALSE(file.ok()) << path;
    EXPECT_EQ(file.error().message, message);
    EXPECT_EQ(file.error().code, ErrorCode::kBadInput);
  }
  EXPECT_EQ(OpenToRead(Path("none")).error().message, "No such file or directory");
}

TEST_F(FileTest, WritesToFilesDevicesAndOpenPipesOnly) {
  EXPECT_EQ(OpenToWrite(MakePipe()).error().message, "it is a named pipe, expected a regular file");
  EXPECT_EQ(OpenToWrite(MakeSocket()).error().message, "it is a socket, expected a regular file");
  EXPECT_EQ(OpenToWrite(folder_).error().message, "Is a directory");
  EXPECT_TRUE(OpenToWrite("/dev/null").ok());
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  const FileDescriptor reading(ends[0]);
  const FileDescriptor writing(ends[1]);
  const Result<FileDescriptor> pipe = OpenToWrite("/proc/self/fd/" + std::to_string(writing.get()));
  ASSERT_TRUE(pipe.ok()) << pipe.error().message;
  EXPECT_TRUE(WriteAll(pipe.value().get(), "text"));
  char text[5] = {};
  EXPECT_EQ(read(reading.get(), text, 4), 4);
  EXPECT_STREQ(text, "text");
}

TEST_F(FileTest, ACheckLeavesEverythingAsItWas) {
  Write("old", "old");
  EXPECT_TRUE(CheckWritable(Path("old")).ok());
  EXPECT_TRUE(CheckWritable(Path("new")).ok());
  EXPECT_EQ(Read("old"), "old");
  EXPECT_EQ(FilesInFolder(), 1u);
  EXPECT_EQ(CheckWritable(Path("none/new")).error().message, "No such file or directory");
  EXPECT_EQ(CheckWritable(MakePipe()).error().message, "it is a named pipe, expected a regular file");
}

TEST_F(FileTest, AFileIsReplacedAsAWhole) {
  Write("file", "old");
  std::filesystem::permissions(Path("file"), std::filesystem::perms(0640));
  std::filesystem::create_symlink("file", Path("link"));
  ASSERT_TRUE(WriteWholeFile(Path("link"), "new").ok());
  EXPECT_EQ(Read("file"), "new");
  EXPECT_TRUE(std::filesystem::is_symlink(Path("link")));
  EXPECT_EQ(std::filesystem::status(Path("file")).permissions(), std::filesystem::perms(0640));
  EXPECT_EQ(FilesInFolder(), 2u);
}

TEST_F(FileTest, ANewFileHasThePermissionsOfTheProcess) {
  const mode_t before = umask(027);
  const Status status = WriteWholeFile(Path("file"), "new");
  umask(before);
  ASSERT_TRUE(status.ok());
  EXPECT_EQ(std::filesystem::status(Path("file")).permissions(), std::filesystem::perms(0640));
}

TEST_F(FileTest, ALinkWithoutATargetMakesIt) {
  std::filesystem::create_symlink("target", Path("link"));
  ASSERT_TRUE(WriteWholeFile(Path("link"), "new").ok());
  EXPECT_EQ(Read("target"), "new");
}

TEST_F(FileTest, AFullDiskLeavesTheOldFileAndNothingElse) {
  Write("file", "old");
  Status status;
  {
    const FullDisk full(1000);
    status = WriteWholeFile(Path("file"), std::string(2000, 'x'));
  }
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().ToString(), Path("file") + ": error: cannot write: File too large");
  EXPECT_EQ(Read("file"), "old");
  EXPECT_EQ(FilesInFolder(), 1u);
}

TEST_F(FileTest, AReplacementThatIsNotCommittedLeavesNothing) {
  ASSERT_TRUE(FileReplacement::Prepare(Path("file"), "new").ok());
  EXPECT_EQ(FilesInFolder(), 0u);
}

TEST_F(FileTest, ADeviceIsWrittenToAndNeverReplaced) {
  std::filesystem::create_symlink("/dev/full", Path("full"));
  EXPECT_THAT(WriteWholeFile(Path("full"), "x").error().message, HasSubstr("cannot write: No space left on device"));
  EXPECT_FALSE(FileReplacement::Prepare(Path("full"), "x").ok());
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/full"));
  EXPECT_EQ(WriteWholeFile(MakePipe(), "x").error().message,
            "cannot write: it is a named pipe, expected a regular file");
}

TEST_F(FileTest, AFolderIsRemovedWithAllInItAndWithoutMemory) {
  Write("kept", "x");
  for (const std::string folder : {"tree", "tree/inner", "tree/inner/empty"})
    std::filesystem::create_directory(Path(folder));
  for (int i = 0; i < 500; ++i)
    Write("tree/inner/a file with a long name, so that many are read at once " + std::to_string(i), "x");
  Write("tree/.hidden", "x");
  std::filesystem::create_symlink(folder_, Path("tree/link"));
  EXPECT_EQ(test::StatusWithoutMemory([tree = Path("tree")] { RemoveAll(tree); }), 0);
  EXPECT_FALSE(std::filesystem::exists(Path("tree")));
  EXPECT_EQ(Read("kept"), "x");
  RemoveAll(Path("kept"));
  RemoveAll(Path("none"));
  EXPECT_EQ(FilesInFolder(), 0u);
}

TEST_F(FileTest, AStreamedFileKeepsWhatWasWrittenBeforeAnError) {
  OutputFile file = OutputFile::Create(Path("file")).value();
  Status status;
  {
    const FullDisk full(100'000);
    for (int i = 0; i < 3000 && status.ok(); ++i) {
      file.Append(std::string(99, 'x'));
      status = file.EndLine();
    }
  }
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().ToString(), Path("file") + ": error: cannot write: File too large");
  EXPECT_EQ(file.Close().error().message, status.error().message);
  EXPECT_EQ(Read("file").size(), 100'000u);
}

}  // namespace
}  // namespace troupe
