#include "filasofia/prefab/expert_session.h"

#include "filasofia/core/error.h"
#include "filasofia/core/text.h"
#include "filasofia/metric/session_file.h"

#include <filesystem>
#include <utility>

namespace filasofia::prefab {
namespace fs = std::filesystem;

std::string ExpertSession::find(const std::string& file, std::vector<std::string> words)
{
    if (expert_ || found_) return {};
    file_ = file;
    part_ = fs::path(file).replace_extension(".part.jsonl").string();
    std::error_code problem;
    try {
        if (fs::exists(file, problem)) {
            found_ = metric::readSession(file);
            return {};
        }
        fs::create_directories(fs::path(file).parent_path(), problem);
        if (problem) fail(fs::path(file).parent_path().string(), ": ", problem.message());
        words.insert(words.end(), {"--session", part_});
        expert_ = std::make_unique<ChildProgram>(fs::read_symlink("/proc/self/exe").string(), words);
    } catch (const std::exception& error) {
        return text("No expert: ", error.what());
    }
    return "The expert is at work, and will be shown";
}

std::optional<metric::Session> ExpertSession::poll()
{
    if (found_) return std::exchange(found_, std::nullopt);
    const std::optional<std::string> ended = expert_ ? expert_->ended() : std::nullopt;
    if (!ended) return std::nullopt;
    expert_.reset();
    said_ = "";
    std::error_code problem;
    try {
        if (!ended->empty()) fail(*ended);
        fs::rename(part_, file_);
        return metric::readSession(file_);
    } catch (const std::exception& error) {
        said_ = text("No expert: ", error.what());
    }
    fs::remove(part_, problem);
    return std::nullopt;
}

std::optional<std::string> ExpertSession::news() { return std::exchange(said_, std::nullopt); }

} // namespace filasofia::prefab
