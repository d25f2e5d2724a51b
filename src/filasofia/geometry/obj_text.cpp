#include "filasofia/geometry/obj_text.h"

#include "filasofia/geometry/number_source.h"

#include <array>
#include <vector>

// The format: Wavefront, Advanced Visualizer manual, appendix B1, "Object files (.obj)".
namespace filasofia::geometry {
namespace {

constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";

struct Kind {
    std::string_view keyword, plural;
    std::size_t least, most; ///< numbers of a line
};
/// In the order in which a corner of a face names them.
constexpr std::array<Kind, 3> kKinds = {Kind{"v", "vertices", 3, 6}, Kind{"vt", "texture coordinates", 1, 3},
                                        Kind{"vn", "normals", 3, 3}};

using Numbers = std::array<std::int64_t, 3>; ///< one for each kind; a corner has 0 for what it does not name

class ObjText {
public:
    ObjText(std::string_view bytes, std::string_view name) : rest_(bytes), name_(name)
    {
        if (rest_.starts_with(kByteOrderMark)) rest_.remove_prefix(kByteOrderMark.size());
        out_.reserve(bytes.size() + bytes.size() / 8);
    }

    std::string checked()
    {
        while (!rest_.empty()) takeLine();
        // A face may stand before what it names.
        for (std::size_t kind = 0; kind < kKinds.size(); ++kind)
            if (highest_[kind] > counts_[kind])
                NumberSource({}, name_, highestLine_[kind])
                    .failHere("a face names number ", highest_[kind], " of the ", kKinds[kind].plural,
                              "; the file has ", counts_[kind]);
        return std::move(out_);
    }

private:
    void takeLine();
    std::string_view nextLine();
    void takeNumbers(NumberSource& words, std::size_t kind);
    void takeFace(NumberSource& words);
    Numbers cornerIn(const NumberSource& words, std::string_view word);

    std::string_view rest_, name_;
    std::size_t line_ = 0; ///< in which the words begin
    std::size_t lines_ = 0;
    std::string joined_; ///< the line, if a \ at its end makes it go on
    std::string out_;
    Numbers counts_{}, highest_{};
    std::array<std::size_t, 3> highestLine_{};
};

std::string_view ObjText::nextLine()
{
    const std::size_t end = std::min(rest_.find('\n'), rest_.size());
    std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    ++lines_;
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line;
}

void ObjText::takeLine()
{
    std::string_view line = nextLine();
    line_ = lines_;
    if (line.ends_with('\\')) {
        joined_.clear();
        for (; line.ends_with('\\') && !rest_.empty(); line = nextLine())
            joined_.append(line.substr(0, line.size() - 1)) += ' ';
        joined_ += line;
        line = joined_;
    }
    NumberSource words(line, name_, line_);
    words.takeComments();
    const std::string_view keyword = words.wordOnThisLine();
    for (std::size_t kind = 0; kind < kKinds.size(); ++kind)
        if (keyword == kKinds[kind].keyword) return takeNumbers(words, kind);
    if (keyword == "f") return takeFace(words);
    (out_ += line) += '\n';
}

void ObjText::takeNumbers(NumberSource& words, std::size_t kind)
{
    const Kind& of = kKinds[kind];
    out_ += of.keyword;
    std::size_t count = 0;
    double last = 0.0;
    for (std::string_view word = words.wordOnThisLine(); !word.empty(); word = words.wordOnThisLine()) {
        last = words.realIn(word, "a number of '" + std::string(of.keyword) + "'");
        out_ += word.starts_with('.') ? " 0" : " ";
        out_ += word;
        ++count;
    }
    if (kind == 1 && count == 1) out_ += " 0"; // a place along a curve
    out_ += '\n';
    // A vertex has a position, a position with a weight, or a position with a colour.
    if (count < of.least || count > of.most || count == 5)
        words.failHere("'", of.keyword, "' must have ",
                       kind == 0   ? "3 numbers (with a weight 4, with a colour 6)"
                       : kind == 1 ? "1 to 3 numbers"
                                   : "3 numbers",
                       ", got ", count);
    if (kind == 0 && count == 4 && last == 0.0) words.failHere("the weight of a vertex must not be 0");
    ++counts_[kind];
}

void ObjText::takeFace(NumberSource& words)
{
    Numbers first{};
    out_ += 'f';
    std::size_t corners = 0;
    for (std::string_view word = words.wordOnThisLine(); !word.empty(); word = words.wordOnThisLine(), ++corners) {
        const Numbers corner = cornerIn(words, word);
        if (corners == 0) first = corner;
        for (std::size_t kind = 1; kind < kKinds.size(); ++kind)
            if ((corner[kind] == 0) != (first[kind] == 0))
                words.failHere("all corners of a face must name ", kKinds[kind].plural, ", or none, got ",
                               quoted(word));
        (out_ += ' ') += word;
    }
    if (corners == 0) words.failHere("a face must name at least 1 vertex, got 0");
    out_ += '\n';
}

/// v, v/vt, v//vn or v/vt/vn. Numbers count from 1, and negative ones back from the last so far.
Numbers ObjText::cornerIn(const NumberSource& words, std::string_view word)
{
    const auto refuse = [&] {
        words.failHere("a corner of a face must be v, v/vt, v//vn or v/vt/vn in whole numbers, got ", quoted(word));
    };
    Numbers corner{};
    std::string_view rest = word;
    std::size_t kind = 0;
    for (bool more = true; more; ++kind) {
        if (kind == kKinds.size()) refuse();
        const std::size_t end = std::min(rest.find('/'), rest.size());
        const std::string_view number = rest.substr(0, end);
        more = end < rest.size();
        rest.remove_prefix(std::min(end + 1, rest.size()));
        if (number.empty()) {
            if (kind != 1 || !more) refuse();
            continue;
        }
        const std::int64_t index = words.integerIn(number, "a corner of a face");
        if (index == 0 || -index > counts_[kind])
            words.failHere("a face names number ", index, " of the ", kKinds[kind].plural,
                           index == 0 ? "; they count from 1" : "; so far the file has ",
                           index == 0 ? "" : std::to_string(counts_[kind]));
        if (index > highest_[kind]) highest_[kind] = index, highestLine_[kind] = line_;
        corner[kind] = index;
    }
    return corner;
}

} // namespace

std::string checkedObj(std::string_view bytes, std::string_view name) { return ObjText(bytes, name).checked(); }

} // namespace filasofia::geometry
