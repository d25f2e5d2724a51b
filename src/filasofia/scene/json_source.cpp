#include "filasofia/scene/json_source.h"

#include "filasofia/core/error.h"
#include "filasofia/core/user_file.h"

#include <algorithm>
#include <functional>
#include <set>
#include <vector>

namespace filasofia::scene {
namespace {

constexpr std::uintmax_t kMaxSceneFile = 16 << 20; // [bytes]
constexpr int kMaxDepth = 64;

/// "FILE:LINE:COLUMN" of a byte of a text.
std::string placeAt(const SourceFile& file, std::string_view text, std::size_t byte)
{
    const std::string_view before = text.substr(0, byte);
    const auto line = 1 + std::ranges::count(before, '\n');
    const auto start = before.rfind('\n');
    return filasofia::text(file.shown, ":", line, ":", byte - (start == std::string_view::npos ? 0 : start + 1) + 1);
}

/// What nlohmann says is wrong, without its number and its own way to say where.
std::string reasonOf(const Json::exception& problem)
{
    std::string_view what = problem.what();
    if (const auto at = what.find("] "); at != std::string_view::npos) what.remove_prefix(at + 2);
    if (const auto at = what.find("column "); at != std::string_view::npos) {
        what.remove_prefix(at);
        if (const auto colon = what.find(": "); colon != std::string_view::npos) what.remove_prefix(colon + 2);
    }
    return std::string(what);
}

/// What nearly always is wrong where a text cannot be read on: words for people.
std::string faultAt(std::string_view text, std::size_t byte, const Json::exception& problem)
{
    const std::string_view blanks = " \t\r\n";
    if (text.find_first_not_of(blanks) == std::string_view::npos) return "the file is empty";
    const auto before = byte == 0 ? std::string_view::npos : text.find_last_not_of(blanks, byte - 1);
    const bool closes = byte < text.size() && (text[byte] == '}' || text[byte] == ']');
    if (closes && before != std::string_view::npos && text[before] == ',')
        return filasofia::text("there must be no comma before '", text[byte], "'");
    return filasofia::text("this is no JSON: ", reasonOf(problem));
}

/// Finds members that are given twice, of which nlohmann would take the last.
class MemberCheck {
public:
    /// Called for every part of the text; remembers which member, counted from 0, is the first one that is repeated.
    bool operator()(int /*depth*/, Json::parse_event_t event, Json& part)
    {
        if (event == Json::parse_event_t::object_start) names_.emplace_back();
        if (event == Json::parse_event_t::object_end) names_.pop_back();
        if (event == Json::parse_event_t::key) {
            if (!names_.back().insert(part.get<std::string>()).second && repeated < 0) repeated = count_;
            ++count_;
        }
        return true;
    }

    int repeated = -1;

private:
    int count_ = 0;
    std::vector<std::set<std::string>> names_;
};

} // namespace

/// Walks through a text that is known to be JSON, together with its values, and notes where each begins.
class PlaceFinder {
public:
    PlaceFinder(const SourceFile& file, std::string_view text, JsonSources& sources)
        : file_(file), text_(text), sources_(sources)
    {
    }

    /// Refuses the member of this number, counted from 0 through the whole text.
    [[noreturn]] void refuseMember(int number)
    {
        for (skipBlanks();; skipBlanks()) {
            const std::size_t begin = at_;
            if (text_[at_] != '"') {
                ++at_;
                continue;
            }
            skipString();
            const std::string_view name = text_.substr(begin, at_ - begin);
            skipBlanks();
            if (text_[at_] != ':' || number-- != 0) continue;
            at_ = begin;
            refuse(text(name, " is given twice"));
        }
    }

    void walk(const Json& value, int depth = 0)
    {
        skipBlanks();
        if (depth > kMaxDepth) refuse(text("lists and objects must be nested at most ", kMaxDepth, " deep"));
        sources_.positions_[&value] = {&file_, line_, static_cast<int>(at_ - lineStart_) + 1};
        if (value.is_object())
            walkObject(value, depth);
        else if (value.is_array())
            walkArray(value, depth);
        else if (text_[at_] == '"')
            skipString();
        else
            while (at_ < text_.size() && std::string_view(",]}/ \t\r\n").find(text_[at_]) == std::string_view::npos)
                ++at_;
    }

private:
    void walkObject(const Json& object, int depth)
    {
        for (++at_;; ++at_) {
            skipBlanks();
            if (text_[at_] == '}') break;
            const std::size_t begin = at_;
            skipString();
            const auto name = Json::parse(text_.substr(begin, at_ - begin)).get<std::string>();
            skipBlanks();
            ++at_; // the colon
            walk(object.at(name), depth + 1);
            skipBlanks();
            if (text_[at_] == '}') break;
        }
        ++at_;
    }

    void walkArray(const Json& array, int depth)
    {
        ++at_;
        for (const Json& each : array) {
            walk(each, depth + 1);
            skipBlanks();
            if (text_[at_] == ',') ++at_;
        }
        skipBlanks();
        ++at_; // the bracket
    }

    void skipBlanks()
    {
        for (; at_ < text_.size(); ++at_) {
            const char c = text_[at_];
            if (c == '/') {
                skipComment();
            } else if (c == '\n') {
                ++line_;
                lineStart_ = at_ + 1;
            } else if (c != ' ' && c != '\t' && c != '\r' && at_ >= bomEnd_) {
                return;
            }
        }
    }

    /// Stops at the last character of the comment.
    void skipComment()
    {
        if (text_[at_ + 1] == '/') {
            at_ = std::min(text_.find_first_of("\n\r", at_), text_.size()) - 1; // as nlohmann ends it
            return;
        }
        const std::size_t end = text_.find("*/", at_ + 2) + 1;
        for (; at_ < end; ++at_)
            if (text_[at_] == '\n') {
                ++line_;
                lineStart_ = at_ + 1;
            }
    }

    void skipString()
    {
        for (++at_; text_[at_] != '"'; ++at_)
            if (text_[at_] == '\\') ++at_;
        ++at_;
    }

    [[noreturn]] void refuse(const std::string& what) const { fail(placeAt(file_, text_, at_), ": ", what); }

    const SourceFile& file_;
    const std::string_view text_;
    JsonSources& sources_;
    const std::size_t bomEnd_ = text_.starts_with("\xef\xbb\xbf") ? 3 : 0; // a byte order mark, which JSON skips
    std::size_t at_ = 0, lineStart_ = 0;
    int line_ = 1;
};

const SourceFile& JsonSources::read(const std::filesystem::path& path, std::string shown)
{
    const std::string text = readFile(path, shown, kMaxSceneFile);
    SourceFile& file = files_.emplace_back(SourceFile{path, std::move(shown), Json()});
    // nlohmann takes a zero byte for the end of a comment, or of the file.
    if (const auto zero = text.find('\0'); zero != std::string::npos)
        fail(placeAt(file, text, zero), ": this is no JSON: there is a byte of value 0");
    MemberCheck check;
    try {
        file.root = Json::parse(text, std::ref(check), true, true); // with comments
    } catch (const Json::parse_error& problem) {
        const std::size_t byte = std::min(problem.byte == 0 ? 0 : problem.byte - 1, text.size());
        fail(placeAt(file, text, byte), ": ", faultAt(text, byte, problem));
    } catch (const Json::exception& problem) { // a number beyond the range of a double, between apostrophes
        const std::string reason = reasonOf(problem);
        const auto first = reason.find('\''), last = reason.rfind('\'');
        const auto at = first < last ? text.find(reason.substr(first + 1, last - first - 1)) : std::string::npos;
        fail(at == std::string::npos ? file.shown : placeAt(file, text, at), ": this is no JSON: ", reason);
    }
    if (check.repeated >= 0) PlaceFinder(file, text, *this).refuseMember(check.repeated);
    PlaceFinder(file, text, *this).walk(file.root);
    return file;
}

std::string JsonSources::placeOf(const Json& value) const
{
    const Position& at = positions_.at(&value);
    return text(at.file->shown, ":", at.line, ":", at.column);
}

const SourceFile& JsonSources::fileOf(const Json& value) const { return *positions_.at(&value).file; }

} // namespace filasofia::scene
