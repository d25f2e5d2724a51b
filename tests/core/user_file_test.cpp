#include "filasofia/core/user_file.h"

#include "filasofia/core/error.h"

#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <thread>

namespace user_file_test {

using namespace filasofia;

namespace {

struct Scratch {
    Scratch() = default;
    explicit Scratch(const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }
    ~Scratch() { std::filesystem::remove(path); }
    std::string path =
        (std::filesystem::temp_directory_path() / ("filasofia_user_file_test_" + std::to_string(getpid()))).string();
};

std::vector<std::string> linesOf(const std::string& path, const LineReader::Limits& limits = {})
{
    LineReader reader(path, "file", limits);
    std::vector<std::string> lines;
    while (const auto line = reader.next()) lines.emplace_back(*line);
    return lines;
}

} // namespace

TEST_CASE("lines are read without their ends, whatever they are and wherever a read ends")
{
    CHECK(linesOf(Scratch("").path).empty());
    const std::string longLine(4096, 'x');
    std::string many;
    std::vector<std::string> expected;
    for (int i = 0; i < 100; ++i) {
        many += longLine + (i % 2 ? "\n" : "\n\n"); // 200 kB: several reads
        expected.push_back(longLine);
        if (i % 2 == 0) expected.emplace_back();
    }
    CHECK(linesOf(Scratch(many).path) == expected);
    CHECK(linesOf(Scratch("a\r\n\nb").path) == std::vector<std::string>{"a", "", "b"});
    CHECK(linesOf(Scratch("a\n").path) == std::vector<std::string>{"a"});
}

TEST_CASE("a line or file beyond its limit is refused, naming the line")
{
    const Scratch file("short\n" + std::string(200, 'x') + "\n");
    CHECK_THROWS_WITH(linesOf(file.path, {.line = 100}), "file: line 2: must have at most 100 bytes, got more");
    CHECK_THROWS_WITH(linesOf(file.path, {.bytes = 100}), "file: must have at most 100 bytes, got more");
    CHECK(linesOf(file.path, {.bytes = 207, .line = 200}).size() == 2);
    CHECK_THROWS_WITH(readFile(file.path, "file", 206), "file: must have at most 206 bytes, got 207");
    CHECK(readFile(file.path, "file", 207).size() == 207);
}

TEST_CASE("a missing file, a device and a directory are refused before anything is read")
{
    const Scratch none;
    CHECK_THROWS_WITH(linesOf(none.path), "file: no such file");
    CHECK_THROWS_WITH(linesOf("/dev/zero"), "file: must be a regular file or a pipe");
    CHECK_THROWS_WITH(linesOf("/tmp"), "file: must be a file, got a directory");
    CHECK_THROWS_WITH(readFile(none.path, "file"), "file: no such file");
    CHECK_THROWS_WITH(readFile("", "file"), "file: no such file");
    CHECK_THROWS_WITH(readFile("/dev/zero", "file"), "file: is not a regular file");
    CHECK_THROWS_WITH(readFile("/tmp", "file"), "file: must be a file, got a directory");
    CHECK_THROWS_WITH(readFile(std::string(5000, 'x'), "file"), Catch::StartsWith("file: cannot be read: "));
}

TEST_CASE("a pipe is read to its end, and one that sends nothing is given up")
{
    const Scratch pipe;
    REQUIRE(::mkfifo(pipe.path.c_str(), 0600) == 0);
    CHECK_THROWS_WITH(readFile(pipe.path, "file"), "file: is not a regular file");
    CHECK_THROWS_WITH(linesOf(pipe.path, {.wait = 0.05}), "file: is a pipe into which nothing was written for 0.05 s");
    std::thread writer([&] { std::ofstream(pipe.path) << "one\ntwo\n"; });
    CHECK(linesOf(pipe.path) == std::vector<std::string>{"one", "two"});
    writer.join();

    std::signal(SIGPIPE, SIG_IGN); // the writer sees the closed pipe in its stream
    std::thread endless([&] {
        std::ofstream out(pipe.path);
        while (out << "one\n" << std::flush) {
        }
    });
    CHECK_THROWS_WITH(linesOf(pipe.path, {.bytes = 100'000}), "file: must have at most 100000 bytes, got more");
    endless.join();
}

} // namespace user_file_test
