#include "filasofia/prefab/child_program.h"

#include "filasofia/core/error.h"
#include "filasofia/core/text.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstring>
#include <filesystem>

namespace filasofia::prefab {

ChildProgram::ChildProgram(const std::string& program, const std::vector<std::string>& words)
    : errors_(memfd_create("stderr", MFD_CLOEXEC))
{
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    if (errors_ >= 0) posix_spawn_file_actions_adddup2(&files, errors_, STDERR_FILENO);
    std::vector<char*> arguments{const_cast<char*>(program.c_str())}; // execve(2) takes them as non-const
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    const int problem = posix_spawnp(&process_, program.c_str(), &files, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&files);
    if (problem == 0) return;
    process_ = -1;
    if (errors_ >= 0) close(errors_);
    fail("the program '", program, "' cannot be started: ", std::strerror(problem));
}

ChildProgram::~ChildProgram()
{
    if (process_ >= 0 && !left_ && !ended()) {
        kill(process_, SIGKILL);
        waitpid(process_, nullptr, 0);
    }
    if (errors_ >= 0) close(errors_);
}

std::optional<std::string> ChildProgram::ended()
{
    if (result_) return result_;
    int status = 0;
    const pid_t done = waitpid(process_, &status, WNOHANG);
    if (done == 0) return std::nullopt;
    if (done > 0 && WIFEXITED(status) && WEXITSTATUS(status) == 0) return result_ = std::string();
    const std::string said = lastError();
    const int code = done > 0 && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return result_ = !said.empty() ? said : code >= 0 ? text("exit code ", code) : std::string("it was ended");
}

std::string ChildProgram::lastError() const
{
    if (errors_ < 0) return {};
    char last[1024];
    const off_t end = lseek(errors_, 0, SEEK_END), from = std::max<off_t>(0, end - off_t(sizeof last));
    const ssize_t count = pread(errors_, last, sizeof last, from);
    std::string said(last, count > 0 ? std::size_t(count) : 0);
    while (!said.empty() && (said.back() == '\n' || said.back() == ' ')) said.pop_back();
    return said.substr(said.find_last_of('\n') + 1); // npos + 1 is 0
}

std::string programBeside(const std::string& name)
{
    std::error_code none;
    const std::filesystem::path own = std::filesystem::read_symlink("/proc/self/exe", none);
    const std::filesystem::path beside = own.parent_path() / name;
    return !own.empty() && access(beside.c_str(), X_OK) == 0 ? beside.string() : name;
}

} // namespace filasofia::prefab
