#include "filasofia/scene/xml_source.h"

#include "filasofia/core/error.h"
#include "filasofia/core/suggestion.h"
#include "filasofia/core/user_file.h"
#include "filasofia/core/word.h"
#include "filasofia/scene/path_within.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace filasofia::scene {
namespace {

constexpr std::uintmax_t kMaxXmlFile = 64 << 20; // [bytes]
constexpr std::size_t kMaxXmlFiles = 64;
constexpr int kMaxXmlDepth = 200;
constexpr std::size_t kMaxNotes = 200;
constexpr std::string_view kBlanks = " \t\r\n";

/// "LINE:COLUMN" of a byte.
std::string lineAndColumn(const XmlFile& file, std::size_t byte)
{
    const auto next = std::ranges::upper_bound(file.starts, byte);
    const auto line = next - file.starts.begin();
    return text(line, ":", byte - *(next - 1) + 1);
}

template <class Number> std::optional<Number> parsed(std::string_view word)
{
    if (word.starts_with('+')) word.remove_prefix(1);
    Number value{};
    const auto [end, problem] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (problem != std::errc{} || end != word.data() + word.size()) return {};
    return value;
}

std::string quoted(std::string_view words) { return text("'", shortened(words), "'"); }

/// Refuses what no reader below expects: nesting that would exhaust the stack, attributes that are given twice.
void checkTree(const XmlFile& file)
{
    int depth = 0;
    for (pugi::xml_node node = file.document.first_child(); node;) {
        const Element element{node, &file};
        if (depth > kMaxXmlDepth) fail(element.place(), ": is nested more than ", kMaxXmlDepth, " deep");
        std::vector<std::string_view> names;
        for (const pugi::xml_attribute each : node.attributes()) names.emplace_back(each.name());
        std::ranges::sort(names);
        if (const auto twice = std::ranges::adjacent_find(names); twice != names.end())
            fail(element.place(), ": ", element.path(), ".", shortened(*twice), " is given twice");
        if (const pugi::xml_node inner = node.first_child()) {
            node = inner;
            ++depth;
            continue;
        }
        while (node && !node.next_sibling()) {
            node = node.parent();
            --depth;
        }
        if (node) node = node.next_sibling();
    }
}

} // namespace

std::string Element::place() const
{
    const std::ptrdiff_t byte = node.offset_debug();
    if (byte < 0) return file->shown;
    return text(file->shown, ":", lineAndColumn(*file, static_cast<std::size_t>(byte)));
}

std::string Element::path() const
{
    std::string path;
    for (pugi::xml_node each = node; each.type() == pugi::node_element; each = each.parent()) {
        const char* const name = each.attribute("name").value();
        const std::string step =
            *name ? text(shortened(each.name()), " ", quoted(name)) : std::string(shortened(each.name()));
        path = path.empty() ? step : text(step, "/", path);
        if (path.size() > 400) return "…/" + path;
    }
    return path;
}

std::vector<Attribute> Attributes::findAll(std::string_view name) const
{
    std::vector<Attribute> all;
    for (const Element& each : layers_)
        if (const auto found = Attributes(each).find(name)) all.push_back(*found);
    return all;
}

std::optional<Attribute> Attributes::findAny(std::initializer_list<std::string_view> names) const
{
    for (const Element& layer : layers_)
        for (const pugi::xml_attribute each : layer.node.attributes())
            for (const std::string_view name : names)
                if (name == each.name()) return Attribute{layer, name, each.value()};
    return {};
}

XmlReader::XmlReader(const std::filesystem::path& file, const ImportOptions& options, std::string_view kind)
    : folder_(std::filesystem::absolute(file.has_parent_path() ? file.parent_path() : ".")), options_(options),
      kind_(kind)
{
    std::error_code problem;
    for (const std::filesystem::path& package : options.packages)
        if (!std::filesystem::is_directory(package, problem))
            fail("package must be a folder, got ", quoted(std::string_view(package.native())));
}

const XmlFile& XmlReader::read(const std::filesystem::path& path, const std::string& shown)
{
    if (files_.size() >= kMaxXmlFiles) fail(shown, ": ", kind_, " may have at most ", kMaxXmlFiles, " files");
    const std::string bytes = readFile(path, shown, kMaxXmlFile);
    XmlFile& file = files_.emplace_back();
    file.path = path;
    file.shown = shown;
    file.starts = {0};
    for (std::size_t i = 0; i < bytes.size(); ++i)
        if (bytes[i] == '\n') file.starts.push_back(i + 1);
    if (bytes.find_first_not_of(kBlanks) == std::string::npos) fail(shown, ": is empty");
    const pugi::xml_parse_result result =
        file.document.load_buffer(bytes.data(), bytes.size(), pugi::parse_default, pugi::encoding_utf8);
    if (!result) {
        const auto byte = std::clamp<std::ptrdiff_t>(result.offset, 0, static_cast<std::ptrdiff_t>(bytes.size()));
        fail(shown, ":", lineAndColumn(file, static_cast<std::size_t>(byte)),
             ": this is no XML: ", result.description());
    }
    checkTree(file);
    return file;
}

void XmlReader::refuse(const Attribute& attribute, std::string_view must, std::string_view hint) const
{
    fail(attribute.at.place(), ": ", attribute.at.path(), ".", attribute.name, " ", must, ", got ",
         quoted(attribute.words), hint);
}

void XmlReader::refuse(const Element& element, std::string_view says) const
{
    fail(element.place(), ": ", element.path(), " ", says);
}

void XmlReader::refuseSecond(const std::vector<Element>& elements, const std::vector<std::string_view>& tags) const
{
    for (const std::string_view tag : tags) {
        const auto same = [&](const Element& each) { return each.tag() == tag; };
        const auto first = std::ranges::find_if(elements, same);
        if (first == elements.end()) continue;
        const auto second = std::find_if(first + 1, elements.end(), same);
        if (second != elements.end()) refuse(*second, text("is a second <", tag, ">, where there may be one"));
    }
}

void XmlReader::refuseSecond(const Element& element, std::initializer_list<std::string_view> attributes) const
{
    const Attributes says(element);
    std::string_view first;
    for (const std::string_view name : attributes) {
        const auto found = says.find(name);
        if (found && !first.empty()) refuse(*found, text("must not stand beside ", first));
        if (found) first = name;
    }
}

void XmlReader::tell(const Element& element, const std::string& kind, std::string_view says)
{
    if (options_.strict) fail(element.place(), ": ", element.path(), ": ", says, " (strict)");
    note(element, kind, says);
}

void XmlReader::note(const Element& element, const std::string& kind, std::string_view says)
{
    if (notes_.size() > kMaxNotes || !told_.insert(kind).second) return;
    if (notes_.size() == kMaxNotes)
        notes_.emplace_back("and more that is not read");
    else
        notes_.push_back(text(element.place(), ": ", says));
}

void XmlReader::tellUnread(const Element& element)
{
    tell(element, text("<", element.tag()), text("<", shortened(element.tag()), "> is not read"));
}

void XmlReader::tellUnread(const Element& element, std::initializer_list<std::string_view> carried)
{
    tellUnread(element, std::vector<std::string_view>(carried));
}

void XmlReader::tellUnread(const Element& element, const std::vector<std::string_view>& carried)
{
    for (const pugi::xml_attribute each : element.node.attributes()) {
        const std::string_view name = each.name();
        if (std::ranges::find(carried, name) != carried.end() || name.starts_with("xmlns")) continue;
        tellUnread(element, name, {carried.begin(), carried.end()});
    }
}

void XmlReader::tellUnread(const Element& element, std::string_view attribute, const std::vector<std::string>& meant)
{
    tell(element, text(element.tag(), ".", attribute),
         text("<", shortened(element.tag()), "> ", shortened(attribute), " is not read", didYouMean(attribute, meant)));
}

std::string XmlReader::word(const Attributes& from, std::string_view name) const
{
    const auto found = from.find(name);
    return found ? std::string(found->words) : std::string();
}

std::string XmlReader::requiredWord(const Attributes& from, std::string_view name) const
{
    std::string found = word(from, name);
    if (found.empty()) refuse(from.element(), text("must say its ", name));
    return found;
}

double XmlReader::number(const Attributes& from, std::string_view name, double standard, const Range& range) const
{
    const auto found = from.find(name);
    return found ? numbers(*found, 1, 1, range).front() : standard;
}

int XmlReader::whole(const Attributes& from, std::string_view name, int standard, const Range& range) const
{
    const auto found = from.find(name);
    if (!found) return standard;
    const std::vector<int> values = wholes(*found, range);
    if (values.size() != 1) refuse(*found, "must be one whole number");
    return values.front();
}

bool XmlReader::flag(const Attributes& from, std::string_view name, bool standard) const
{
    const auto found = from.find(name);
    if (!found) return standard;
    if (found->words == "true" || found->words == "1") return true;
    if (found->words == "false" || found->words == "0") return false;
    refuse(*found, "must be true or false");
}

std::size_t XmlReader::oneOf(const Attributes& from, std::string_view name, std::size_t standard,
                             const std::vector<std::string>& known) const
{
    const auto found = from.find(name);
    if (!found) return standard;
    const auto at = std::ranges::find(known, found->words);
    if (at != known.end()) return static_cast<std::size_t>(at - known.begin());
    std::string list;
    for (const std::string& each : known) list += text(list.empty() ? "" : ", ", each);
    refuse(*found, text("must be one of ", list), didYouMean(found->words, known));
}

Vec3 XmlReader::vector(const Attributes& from, std::string_view name, Vec3 standard, const Range& range) const
{
    const auto found = from.find(name);
    if (!found) return standard;
    const std::vector<double> v = numbers(*found, 3, 3, range);
    return {v[0], v[1], v[2]};
}

std::vector<double> XmlReader::numbers(const Attribute& attribute, std::size_t least, std::size_t most,
                                       const Range& range) const
{
    std::vector<double> values;
    forEachWord(attribute.words, [&](std::string_view word) {
        const auto value = parsed<double>(word);
        if (!value || !std::isfinite(*value)) refuse(attribute, "must consist of finite numbers");
        if (!range.contains(*value)) refuse(attribute, range.text(""));
        values.push_back(*value);
        if (values.size() > most) refuse(attribute, text("must be at most ", most, " numbers"));
    });
    if (values.size() < least) refuse(attribute, text("must be ", least == most ? "" : "at least ", least, " numbers"));
    return values;
}

std::vector<int> XmlReader::wholes(const Attribute& attribute, const Range& range) const
{
    std::vector<int> values;
    forEachWord(attribute.words, [&](std::string_view word) {
        const auto value = parsed<int>(word);
        if (!value) refuse(attribute, "must consist of whole numbers");
        if (!range.contains(*value)) refuse(attribute, range.text(""));
        values.push_back(*value);
    });
    return values;
}

std::filesystem::path XmlReader::allowed(const Attribute& attribute, const std::filesystem::path& path)
{
    const auto contains = [&](const std::filesystem::path& folder) {
        return !pathWithin(std::filesystem::absolute(folder), path).empty();
    };
    if (path.native().find('\0') != std::string::npos) refuse(attribute, "must be the name of a file");
    if (!options_.anyFolder && !contains(folder_) && !std::ranges::any_of(options_.packages, contains))
        refuse(attribute, text("must be a file in the folder of ", kind_, ", also behind links"),
               " (--any-folder allows all)");
    std::error_code problem;
    if (!std::filesystem::exists(path, problem)) refuse(attribute, "must be a file that exists");
    named_.push_back(path);
    return path;
}

std::filesystem::path XmlReader::fileNamed(const Attribute& attribute, const std::filesystem::path& folder)
{
    if (attribute.words.empty()) refuse(attribute, "must name a file");
    return allowed(attribute, folder / std::filesystem::path(attribute.words));
}

std::filesystem::path XmlReader::shared(const Attribute& attribute, const std::filesystem::path& folder)
{
    const std::filesystem::path path = folder / std::filesystem::path(attribute.words);
    if (pathWithin(std::filesystem::absolute(folder), path).empty())
        refuse(attribute, text("must be a file in ", folder.string(), ", also behind links"));
    named_.push_back(path);
    return path;
}

std::optional<std::filesystem::path> XmlReader::packageNamed(const std::string& name) const
{
    std::error_code problem;
    const auto isFolder = [&](const std::filesystem::path& each) {
        return std::filesystem::is_directory(each, problem);
    };
    for (const std::filesystem::path& each : options_.packages) {
        const std::filesystem::path whole = std::filesystem::absolute(each).lexically_normal();
        const std::filesystem::path last = whole.has_filename() ? whole.filename() : whole.parent_path().filename();
        if (last == name) return whole;
        if (isFolder(whole / name)) return whole / name;
    }
    for (std::filesystem::path up = folder_.lexically_normal();; up = up.parent_path()) {
        if (up.filename() == name) return up;
        if (isFolder(up / name)) return up / name;
        if (up == up.parent_path()) return {};
    }
}

std::filesystem::path XmlReader::resourceNamed(const Attribute& attribute)
{
    constexpr std::string_view package = "package://", plain = "file://";
    std::string_view words = attribute.words;
    if (words.starts_with(plain)) words.remove_prefix(plain.size());
    if (!words.starts_with(package)) return fileNamed({attribute.at, attribute.name, words}, folder_);
    words.remove_prefix(package.size());
    const std::size_t slash = words.find('/');
    if (slash == 0 || slash == std::string_view::npos) refuse(attribute, "must be package://NAME/FILE");
    const std::string name(words.substr(0, slash));
    if (name == "." || name == "..") refuse(attribute, "must be package://NAME/FILE");
    const auto found = packageNamed(name);
    if (!found)
        refuse(attribute,
               text("must be in a package that is found: no folder above the file has '", shortened(name), "'"),
               " (--package names one)");
    return allowed(attribute, *found / std::filesystem::path(words.substr(slash + 1)));
}

std::vector<std::filesystem::path> XmlReader::files() const
{
    std::vector<std::filesystem::path> all;
    for (const XmlFile& each : files_) all.push_back(each.path);
    for (const std::filesystem::path& each : named_)
        if (std::ranges::find(all, each) == all.end()) all.push_back(each);
    return all;
}

} // namespace filasofia::scene
