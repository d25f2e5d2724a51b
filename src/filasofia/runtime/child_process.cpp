#include "filasofia/runtime/child_process.h"

#include "filasofia/core/error.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>

namespace filasofia::runtime {
namespace {

constexpr int kSendTimeout = 30; ///< [s] for which the program may take no data

/// The settings of posix_spawn, freed at the end.
struct SpawnPlan {
    posix_spawn_file_actions_t files{};
    posix_spawnattr_t attributes{};
    SpawnPlan()
    {
        posix_spawn_file_actions_init(&files);
        posix_spawnattr_init(&attributes);
        sigset_t none, pipe;
        sigemptyset(&none);
        sigemptyset(&pipe);
        sigaddset(&pipe, SIGPIPE); // a program may have ignored it for itself
        posix_spawnattr_setsigmask(&attributes, &none);
        posix_spawnattr_setsigdefault(&attributes, &pipe);
        posix_spawnattr_setpgroup(&attributes, 0);
        posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
    }
    ~SpawnPlan()
    {
        posix_spawn_file_actions_destroy(&files);
        posix_spawnattr_destroy(&attributes);
    }
    SpawnPlan(const SpawnPlan&) = delete;
    SpawnPlan& operator=(const SpawnPlan&) = delete;
};

void closeOnce(int& file)
{
    if (file >= 0) close(file);
    file = -1;
}

} // namespace

ChildProcess::ChildProcess(const std::string& path, const std::vector<std::string>& arguments)
{
    // A socket instead of a pipe: writing to a socket without a reader makes that call fail and sends no signal to the
    // process.
    int ends[2] = {-1, -1};
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
        fail(path, ": cannot be started: ", std::strerror(errno));
    input_ = ends[0];
    const timeval patience{.tv_sec = kSendTimeout, .tv_usec = 0};
    setsockopt(input_, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
    errorOutput_ = memfd_create("stderr", MFD_CLOEXEC);

    SpawnPlan plan;
    posix_spawn_file_actions_adddup2(&plan.files, ends[1], STDIN_FILENO);
    posix_spawn_file_actions_addopen(&plan.files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    if (errorOutput_ >= 0) posix_spawn_file_actions_adddup2(&plan.files, errorOutput_, STDERR_FILENO);
    std::vector<char*> words{const_cast<char*>(path.c_str())}; // execve(2) takes them as non-const and changes none
    for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
    words.push_back(nullptr);
    const int problem = posix_spawn(&process_, path.c_str(), &plan.files, &plan.attributes, words.data(), environ);
    closeOnce(ends[1]);
    if (problem == 0) return;
    process_ = -1;
    closeOnce(input_);
    closeOnce(errorOutput_);
    fail(path, ": cannot be started: ", std::strerror(problem));
}

ChildProcess::~ChildProcess()
{
    closeOnce(input_);
    if (process_ > 0) {
        kill(process_, SIGKILL);
        waitpid(process_, nullptr, 0);
    }
    closeOnce(errorOutput_);
}

bool ChildProcess::feed(std::span<const unsigned char> data)
{
    while (!data.empty()) {
        const ssize_t taken = send(input_, data.data(), data.size(), MSG_NOSIGNAL);
        if (taken < 0 && errno == EINTR) continue;
        if (taken <= 0) return false;
        data = data.subspan(static_cast<std::size_t>(taken));
    }
    return true;
}

bool ChildProcess::ended(double seconds) const
{
    const int handle = static_cast<int>(syscall(SYS_pidfd_open, process_, 0));
    if (handle < 0) return true; // an old kernel: waitpid() alone waits, without a time limit
    pollfd until{.fd = handle, .events = POLLIN, .revents = 0};
    int ready = 0;
    do ready = poll(&until, 1, static_cast<int>(seconds * 1e3));
    while (ready < 0 && errno == EINTR);
    close(handle);
    return ready > 0;
}

std::string ChildProcess::lastErrorLine() const
{
    if (errorOutput_ < 0) return {};
    const off_t size = lseek(errorOutput_, 0, SEEK_END);
    std::string words(static_cast<std::size_t>(std::clamp<off_t>(size, 0, 2000)), ' ');
    const ssize_t got = pread(errorOutput_, words.data(), words.size(), std::max<off_t>(size - 2000, 0));
    words.resize(static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
    while (!words.empty() && std::isspace(static_cast<unsigned char>(words.back()))) words.pop_back();
    return words.substr(words.find_last_of('\n') + 1); // npos + 1 is the start
}

std::string ChildProcess::finish(double seconds)
{
    closeOnce(input_);
    const bool inTime = ended(seconds);
    if (!inTime) kill(process_, SIGKILL);
    int status = 0;
    while (waitpid(process_, &status, 0) < 0 && errno == EINTR) {
    }
    process_ = -1;
    if (!inTime) return text("it did not end within ", seconds, " s");
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return {};
    const std::string words = lastErrorLine();
    const std::string how =
        WIFSIGNALED(status) ? text("killed by signal ", WTERMSIG(status)) : text("exit code ", WEXITSTATUS(status));
    return words.empty() ? how : text(words, " (", how, ")");
}

std::string programOnPath(const std::string& name)
{
    const char* path = std::getenv("PATH");
    const std::string folders = path ? path : "";
    for (std::size_t at = 0; at <= folders.size();) {
        const std::size_t end = std::min(folders.find(':', at), folders.size());
        const std::filesystem::path file = std::filesystem::path(folders.substr(at, end - at)) / name;
        std::error_code ignored;
        if (std::filesystem::is_regular_file(file, ignored) && access(file.c_str(), X_OK) == 0) return file.string();
        at = end + 1;
    }
    return {};
}

} // namespace filasofia::runtime
