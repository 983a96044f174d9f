#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <string>
#include <thread>

#include "common/base/file.h"
#include "launcher/hosts/host.h"

namespace troupe {
namespace {

// As sshd connects `troupe host`: its input and its output are one socket, and the input is read without waiting.
TEST(HostMessages, AreWrittenAsAWholeWhereTheReaderIsSlow) {
  int ends[2];
  ASSERT_EQ(socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends), 0);
  ASSERT_EQ(fcntl(ends[0], F_SETFL, O_NONBLOCK), 0);
  const std::string text(10'000'000, 'x');
  std::size_t received = 0;
  std::thread reader([&] {
    std::string buffer(65536, ' ');
    for (ssize_t size = 0; (size = read(ends[1], buffer.data(), buffer.size())) > 0;) {
      received += static_cast<std::size_t>(size);
    }
  });
  EXPECT_TRUE(WriteAll(ends[0], text));
  close(ends[0]);
  reader.join();
  close(ends[1]);
  EXPECT_EQ(received, text.size());
}

}  // namespace
}  // namespace troupe
