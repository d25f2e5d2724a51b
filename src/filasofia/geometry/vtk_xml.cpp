#include "filasofia/geometry/vtk_xml.h"

#include <algorithm>
#include <bit>
#include <concepts>
#include <cstring>
#include <zlib.h>

// The format: VTK user's guide, "XML file formats". An array is text, or a size in bytes and the data, or, if deflated,
// the number of blocks, the size of each and of the last (0: as the others), the deflated size of each, and the blocks.
namespace filasofia::geometry {
namespace {

/// Deflated data are at most this much smaller (zlib's technical details).
constexpr std::uint64_t kMostDeflated = 1040;

struct Appended {
    std::string_view head; ///< the file before the data
    std::string_view data; ///< from behind the '_'; all of it if the data are raw
};

/// Splits off the appended data, which need not be XML.
Appended splitAppended(std::string_view bytes)
{
    const std::size_t tag = bytes.find("<AppendedData");
    const std::size_t end = bytes.find('>', tag == std::string_view::npos ? bytes.size() : tag);
    if (end == std::string_view::npos) return {bytes, {}};
    const std::size_t mark = bytes.find('_', end);
    return {bytes.substr(0, end + 1), mark == std::string_view::npos ? std::string_view{} : bytes.substr(mark + 1)};
}

} // namespace

VtkXml::VtkXml(std::string_view bytes, std::string_view name) : file_(bytes, name), bytes_(bytes), name_(name)
{
    const auto [head, data] = splitAppended(bytes_);
    appended_ = data;
    const pugi::xml_parse_result result =
        document_.load_buffer(head.data(), head.size(), pugi::parse_default, pugi::encoding_utf8);
    // The end of the file was split off with the data.
    const bool ended = head.size() < bytes_.size() && result.status == pugi::status_end_element_mismatch;
    if (!result && !ended) file_.failAt(lineAt(result.offset), "the file must be XML: ", result.description());
    const pugi::xml_node root = document_.child("VTKFile");
    if (!root) file_.failAt(1, "a VTK XML file must have an element VTKFile");
    const std::string_view order = root.attribute("byte_order").as_string("LittleEndian");
    const std::string_view sizes = root.attribute("header_type").as_string("UInt32");
    if (order != "LittleEndian" && order != "BigEndian")
        failAt(root, "byte_order must be LittleEndian or BigEndian, got ", quoted(order));
    if (sizes != "UInt32" && sizes != "UInt64")
        failAt(root, "header_type must be UInt32 or UInt64, got ", quoted(sizes));
    swapped_ = (order == "LittleEndian") != (std::endian::native == std::endian::little);
    sizeBytes_ = sizes == "UInt64" ? 8 : 4;
    compressor_ = root.attribute("compressor").value();
    appendedBase64_ = std::string_view(root.child("AppendedData").attribute("encoding").as_string("base64")) != "raw";
}

std::string_view VtkXml::type() const { return document_.child("VTKFile").attribute("type").value(); }

pugi::xml_node VtkXml::piece() const
{
    const pugi::xml_node first = child(child(document_.child("VTKFile"), std::string(type()).c_str()), "Piece");
    if (const pugi::xml_node second = first.next_sibling("Piece"))
        failAt(second, "the grid must have one Piece, got a second one; merge them before");
    return first;
}

std::size_t VtkXml::lineAt(std::ptrdiff_t offset) const
{
    const std::ptrdiff_t at = std::clamp<std::ptrdiff_t>(offset, 0, static_cast<std::ptrdiff_t>(bytes_.size()));
    return 1 + static_cast<std::size_t>(std::count(bytes_.begin(), bytes_.begin() + at, '\n'));
}

pugi::xml_node VtkXml::child(const pugi::xml_node& parent, const char* name) const
{
    const pugi::xml_node found = parent.child(name);
    if (!found) failAt(parent, parent.name(), " must have an element ", name);
    return found;
}

pugi::xml_node VtkXml::arrayOf(const pugi::xml_node& parent, const char* name) const
{
    const pugi::xml_node found = parent.find_child_by_attribute("DataArray", "Name", name);
    if (!found) failAt(parent, parent.name(), " must have a DataArray with the Name '", name, "'");
    return found;
}

NumberSource VtkXml::attributeOf(const pugi::xml_node& node, const char* name) const
{
    const std::string_view word = node.attribute(name).value();
    if (word.empty()) failAt(node, node.name(), " must have an attribute ", name);
    return {word, name_, lineOf(node)};
}

std::int64_t VtkXml::countOf(const pugi::xml_node& piece, const char* name) const
{
    NumberSource word = attributeOf(piece, name);
    const std::int64_t count = word.integer(name);
    // No format needs less than a bit for a number.
    const auto most = static_cast<std::int64_t>(kMostDeflated * bytes_.size());
    if (count < 1 || count > most)
        word.failHere(name, " must be in [1, ", most, "], what the file can hold, got ", count);
    return count;
}

template <class Number> std::vector<Number> VtkXml::numbersOf(const pugi::xml_node& array, bool loose) const
{
    if (std::string_view(array.attribute("format").as_string("ascii")) == "ascii") return textOf<Number>(array, loose);
    const std::string_view type = array.attribute("type").value();
    if (type == "Int8") return rawOf<std::int8_t, Number>(array);
    if (type == "UInt8") return rawOf<std::uint8_t, Number>(array);
    if (type == "Int16") return rawOf<std::int16_t, Number>(array);
    if (type == "UInt16") return rawOf<std::uint16_t, Number>(array);
    if (type == "Int32") return rawOf<std::int32_t, Number>(array);
    if (type == "UInt32") return rawOf<std::uint32_t, Number>(array);
    if (type == "Int64") return rawOf<std::int64_t, Number>(array);
    if (type == "UInt64") return rawOf<std::uint64_t, Number>(array);
    if constexpr (std::floating_point<Number>) {
        if (type == "Float32") return rawOf<float, Number>(array);
        if (type == "Float64") return rawOf<double, Number>(array);
    }
    failAt(array, "type must be Int8 to UInt64", std::floating_point<Number> ? ", Float32 or Float64" : "", ", got ",
           quoted(type));
}

template <class Number> std::vector<Number> VtkXml::textOf(const pugi::xml_node& array, bool loose) const
{
    const pugi::xml_text content = array.text();
    NumberSource in(content.get(), name_, content ? lineOf(content.data()) : lineOf(array));
    std::vector<Number> out;
    for (std::string_view word = in.word(); !word.empty(); word = in.word()) {
        if constexpr (std::floating_point<Number>)
            out.push_back(loose ? in.anyRealIn(word) : in.realIn(word, "a number"));
        else
            out.push_back(in.integerIn(word, "a number"));
    }
    return out;
}

template <class Raw> Raw VtkXml::rawAt(const char* at) const
{
    char raw[sizeof(Raw)];
    std::memcpy(raw, at, sizeof raw);
    if (swapped_) std::reverse(std::begin(raw), std::end(raw));
    return std::bit_cast<Raw>(raw);
}

template <class Raw, class Number> std::vector<Number> VtkXml::rawOf(const pugi::xml_node& array) const
{
    const std::string bytes = bytesOf(array);
    std::vector<Number> out;
    out.reserve(bytes.size() / sizeof(Raw));
    for (std::size_t at = 0; at + sizeof(Raw) <= bytes.size(); at += sizeof(Raw))
        out.push_back(static_cast<Number>(rawAt<Raw>(bytes.data() + at)));
    return out;
}

std::uint64_t VtkXml::sizeIn(ArrayBytes& from, const pugi::xml_node& array) const
{
    const std::string_view raw = from.take(sizeBytes_);
    if (raw.size() < sizeBytes_) failAt(array, "the data end before their size");
    return sizeBytes_ == 8 ? rawAt<std::uint64_t>(raw.data()) : rawAt<std::uint32_t>(raw.data());
}

std::string VtkXml::bytesOf(const pugi::xml_node& array) const
{
    const std::string_view format = array.attribute("format").value();
    std::string_view content = array.text().get();
    if (format == "appended") {
        NumberSource word = attributeOf(array, "offset");
        const std::int64_t offset = word.integer("offset");
        if (offset < 0 || static_cast<std::size_t>(offset) > appended_.size())
            failAt(array, "offset must be in [0, ", appended_.size(), "], the size of the appended data, got ", offset);
        content = appended_.substr(static_cast<std::size_t>(offset));
    } else if (format != "binary") {
        failAt(array, "format must be ascii, binary or appended, got ", quoted(format));
    }
    ArrayBytes from(content, format == "binary" || appendedBase64_);
    if (!compressor_.empty() && compressor_ != "vtkZLibDataCompressor")
        failAt(array, "the data must be compressed by vtkZLibDataCompressor or not at all, got ", quoted(compressor_));
    if (!compressor_.empty()) return inflated(from, array);
    const std::uint64_t size = sizeIn(from, array);
    std::string_view raw;
    if (size <= from.most()) raw = from.take(size);
    if (raw.size() < size) failAt(array, "the data end before ", size, " bytes");
    return std::string(raw);
}

std::string VtkXml::inflated(ArrayBytes& from, const pugi::xml_node& array) const
{
    const std::uint64_t blocks = sizeIn(from, array), size = sizeIn(from, array), last = sizeIn(from, array);
    if (blocks > from.most() / sizeBytes_) failAt(array, "the data end before ", blocks, " blocks");
    std::vector<std::uint64_t> packed;
    for (std::uint64_t k = 0; k < blocks; ++k) packed.push_back(sizeIn(from, array));
    std::string out;
    for (std::uint64_t k = 0; k < blocks; ++k) {
        std::string_view block;
        if (packed[k] <= from.most()) block = from.take(packed[k]);
        if (block.size() < packed[k]) failAt(array, "the data end before ", packed[k], " bytes");
        const std::uint64_t whole = k + 1 == blocks && last > 0 ? last : size;
        if (whole > kMostDeflated * packed[k])
            failAt(array, "a block of ", packed[k], " deflated bytes cannot hold ", whole);
        const std::size_t begin = out.size();
        out.resize(begin + whole);
        uLongf found = whole;
        const int code = uncompress(reinterpret_cast<Bytef*>(out.data() + begin), &found,
                                    reinterpret_cast<const Bytef*>(block.data()), static_cast<uLong>(block.size()));
        if (code != Z_OK || found != whole) failAt(array, "block ", k, " of the deflated data is damaged");
    }
    return out;
}

template std::vector<double> VtkXml::numbersOf(const pugi::xml_node&, bool) const;
template std::vector<std::int64_t> VtkXml::numbersOf(const pugi::xml_node&, bool) const;

} // namespace filasofia::geometry
