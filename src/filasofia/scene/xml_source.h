#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/core/suggestion.h"
#include "filasofia/math/pose.h"
#include "filasofia/scene/import.h"

#include <pugixml.hpp>

#include <algorithm>
#include <list>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

/// XML files of other programs, whose elements know their places.
namespace filasofia::scene {

/// A file that was read.
struct XmlFile {
    std::filesystem::path path;
    std::string shown;               ///< as errors name it
    std::vector<std::size_t> starts; ///< bytes at which its lines begin
    pugi::xml_document document;
};

/// An element of one of the files; false if there is none.
struct Element {
    pugi::xml_node node = {};
    const XmlFile* file = nullptr;

    explicit operator bool() const { return static_cast<bool>(node); }
    [[nodiscard]] std::string_view tag() const { return node.name(); }
    [[nodiscard]] bool has(const char* attribute) const { return static_cast<bool>(node.attribute(attribute)); }
    /// "FILE:LINE:COLUMN"
    [[nodiscard]] std::string place() const;
    /// "robot/joint 'elbow'/limit", from the file's first element.
    [[nodiscard]] std::string path() const;
};

/// The words of an attribute, and the element that says it.
struct Attribute {
    Element at;
    std::string_view name;
    std::string_view words;
};

/// The attributes of an element, and behind them those of its defaults, the most specific first.
class Attributes {
public:
    explicit Attributes(Element element) : layers_{element} {}
    explicit Attributes(std::vector<Element> layers) : layers_(std::move(layers)) {}

    [[nodiscard]] Element element() const { return layers_.front(); }
    [[nodiscard]] bool has(std::string_view name) const { return find(name).has_value(); }
    [[nodiscard]] std::optional<Attribute> find(std::string_view name) const { return findAny({name}); }
    /// What all of them say, the most specific first.
    [[nodiscard]] std::vector<Attribute> findAll(std::string_view name) const;
    /// The one of these that the first element that has any of them says.
    [[nodiscard]] std::optional<Attribute> findAny(std::initializer_list<std::string_view> names) const;

private:
    std::vector<Element> layers_;
};

/// Calls `visit` for the words of a list, which blanks separate.
template <class Visit> void forEachWord(std::string_view words, Visit&& visit)
{
    constexpr std::string_view blanks = " \t\r\n";
    for (std::size_t at = words.find_first_not_of(blanks); at != std::string_view::npos;) {
        const std::size_t end = std::min(words.find_first_of(blanks, at), words.size());
        visit(words.substr(at, end - at));
        at = words.find_first_not_of(blanks, end);
    }
}

/// " (did you mean 'elbow'?)" for the name of a map that is nearest to a word; nothing if none is near.
template <class Map> std::string nearestIn(const Map& map, std::string_view word)
{
    std::vector<std::string> known;
    for (const auto& each : map) known.push_back(each.first);
    return didYouMean(word, known);
}

/// All that a file gets when it is read: errors, values, and notes on what is not carried.
class XmlReader {
public:
    XmlReader(const std::filesystem::path& file, const ImportOptions& options, std::string_view kind);

    /// Reads a file; throws an Error if it is no XML, too large or nested too deep, or has an attribute twice.
    const XmlFile& read(const std::filesystem::path& path, const std::string& shown);

    /// Throws the Error "FILE:LINE:COLUMN: <path>.<attribute> must be ..., got '...'".
    [[noreturn]] void refuse(const Attribute& attribute, std::string_view must, std::string_view hint = {}) const;
    [[noreturn]] void refuse(const Element& element, std::string_view says) const;
    /// What a map has under the name that an attribute says; refused if it has none.
    template <class Map>
    [[nodiscard]] const auto& named(const Attribute& name, const Map& map, std::string_view must) const
    {
        const auto found = map.find(std::string(name.words));
        if (found == map.end()) refuse(name, must, nearestIn(map, name.words));
        return found->second;
    }
    /// Refuses a second element of one of these tags, of which there may be one.
    void refuseSecond(const std::vector<Element>& elements, const std::vector<std::string_view>& tags) const;
    /// Refuses a second one of these attributes in an element: they say the same thing in several ways.
    void refuseSecond(const Element& element, std::initializer_list<std::string_view> attributes) const;

    /// Notes that something is meant in another way than the file's program means it, once per `kind`.
    void note(const Element& element, const std::string& kind, std::string_view says);
    /// Notes that something is not read; strict, it is an Error.
    void tell(const Element& element, const std::string& kind, std::string_view says);
    /// The same for an element, and for all attributes of it but these.
    void tellUnread(const Element& element);
    void tellUnread(const Element& element, std::initializer_list<std::string_view> carried);
    void tellUnread(const Element& element, const std::vector<std::string_view>& carried);
    /// The same for one attribute of it; `meant`: those that it may be a slip of.
    void tellUnread(const Element& element, std::string_view attribute, const std::vector<std::string>& meant);

    [[nodiscard]] std::string word(const Attributes& from, std::string_view name) const;
    [[nodiscard]] std::string requiredWord(const Attributes& from, std::string_view name) const;
    [[nodiscard]] double number(const Attributes& from, std::string_view name, double standard,
                                const Range& range = kUsual) const;
    [[nodiscard]] int whole(const Attributes& from, std::string_view name, int standard, const Range& range) const;
    [[nodiscard]] bool flag(const Attributes& from, std::string_view name, bool standard) const;
    /// The index of a word in a list.
    [[nodiscard]] std::size_t oneOf(const Attributes& from, std::string_view name, std::size_t standard,
                                    const std::vector<std::string>& known) const;
    [[nodiscard]] Vec3 vector(const Attributes& from, std::string_view name, Vec3 standard,
                              const Range& range = kUsual) const;
    [[nodiscard]] std::vector<double> numbers(const Attribute& attribute, std::size_t least, std::size_t most,
                                              const Range& range = kUsual) const;
    [[nodiscard]] std::vector<int> wholes(const Attribute& attribute, const Range& range) const;

    /// The path of a file that an attribute names, relative to `folder`; it must be there, and in the file's folder.
    [[nodiscard]] std::filesystem::path fileNamed(const Attribute& attribute, const std::filesystem::path& folder);
    /// The same for a file that the scene shares with others, in a folder that its program says.
    [[nodiscard]] std::filesystem::path shared(const Attribute& attribute, const std::filesystem::path& folder);
    /// The same for what URDF allows: package://, file:// and relative paths.
    [[nodiscard]] std::filesystem::path resourceNamed(const Attribute& attribute);

    [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
    /// The files that were read or named, in order.
    [[nodiscard]] std::vector<std::filesystem::path> files() const;
    [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }
    [[nodiscard]] std::vector<std::string> takeNotes() { return std::move(notes_); }

    static constexpr Range kUsual = closed(-1e12, 1e12); ///< far from overflow, far beyond all that is meant

private:
    [[nodiscard]] std::optional<std::filesystem::path> packageNamed(const std::string& name) const;
    std::filesystem::path allowed(const Attribute& attribute, const std::filesystem::path& path);

    std::filesystem::path folder_;
    const ImportOptions& options_;
    std::string kind_; ///< "a URDF"
    std::list<XmlFile> files_;
    std::vector<std::filesystem::path> named_;
    std::set<std::string> told_;
    std::vector<std::string> notes_;
};

} // namespace filasofia::scene
