#include "filasofia/prefab/session_report.h"

#include "filasofia/core/error.h"
#include "filasofia/core/text.h"

#include <filesystem>

namespace filasofia::prefab {
namespace {

/// Opens a page in the person's browser if this system has a way to. Returns whether it has.
bool openPage(const std::string& page)
{
    try {
        ChildProgram opener("xdg-open", {page});
        opener.leave(); // the browser outlives the trainer
        return true;
    } catch (const Error&) {
        return false;
    }
}

} // namespace

std::string SessionReport::write(const std::string& session, const std::string& program)
{
    std::error_code none;
    page_ = std::filesystem::absolute(std::filesystem::path(session).replace_extension(".html"), none).string();
    try {
        program_ =
            std::make_unique<ChildProgram>(program, std::vector<std::string>{"report", session, "--html", page_});
    } catch (const Error& problem) {
        return text("No report: ", problem.what());
    }
    return "The report is being written";
}

std::optional<std::string> SessionReport::poll()
{
    if (!program_) return std::nullopt;
    const std::optional<std::string> ended = program_->ended();
    if (!ended) return std::nullopt;
    program_.reset();
    if (!ended->empty()) return text("No report: ", *ended);
    return text("Report: ", page_, openPage(page_) ? " (opened)" : "");
}

} // namespace filasofia::prefab
