#include "filasofia/geometry/vtu_reader.h"

#include "filasofia/geometry/array_bytes.h"
#include "filasofia/geometry/vtk_cells.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <pugixml.hpp>
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

class VtuReader {
public:
    VtuReader(std::string_view bytes, std::string_view name) : file_(bytes, name), bytes_(bytes), name_(name) {}

    TetMesh read(const std::string& labels);

private:
    void parse();
    void readPoints(const pugi::xml_node& piece);
    void readCells(const pugi::xml_node& piece);
    void readNumbers(const pugi::xml_node& piece);

    [[nodiscard]] std::size_t lineAt(std::ptrdiff_t offset) const;
    /// The line on which an element or a text begins.
    [[nodiscard]] std::size_t lineOf(const pugi::xml_node& node) const { return lineAt(node.offset_debug()); }
    template <class... Parts> [[noreturn]] void failAt(const pugi::xml_node& node, const Parts&... parts) const
    {
        file_.failAt(lineOf(node), parts...);
    }
    [[nodiscard]] pugi::xml_node child(const pugi::xml_node& parent, const char* name) const;
    [[nodiscard]] pugi::xml_node arrayOf(const pugi::xml_node& parent, const char* name) const;
    [[nodiscard]] NumberSource attributeOf(const pugi::xml_node& node, const char* name) const;
    [[nodiscard]] std::int64_t countOf(const pugi::xml_node& piece, const char* name) const;

    /// The numbers of an array. Floating-point numbers cannot become whole ones. `loose`: a word that is none is NaN.
    template <class Number> std::vector<Number> numbersOf(const pugi::xml_node& array, bool loose = false) const;
    template <class Number> std::vector<Number> textOf(const pugi::xml_node& array, bool loose) const;
    template <class Raw, class Number> std::vector<Number> rawOf(const pugi::xml_node& array) const;
    [[nodiscard]] std::string bytesOf(const pugi::xml_node& array) const;
    [[nodiscard]] std::string inflated(ArrayBytes& from, const pugi::xml_node& array) const;
    [[nodiscard]] std::uint64_t sizeIn(ArrayBytes& from, const pugi::xml_node& array) const;
    template <class Raw> [[nodiscard]] Raw rawAt(const char* at) const;

    NumberSource file_; ///< for errors; everything is read from the document
    std::string_view bytes_, name_;
    Appended appended_;
    pugi::xml_document document_;
    bool swapped_ = false, appendedBase64_ = false;
    std::string_view compressor_; ///< empty: none
    std::size_t sizeBytes_ = 4;   ///< of the sizes before an array's data
    RawTetMesh mesh_;
    VtkCells cells_;
};

std::size_t VtuReader::lineAt(std::ptrdiff_t offset) const
{
    const std::ptrdiff_t at = std::clamp<std::ptrdiff_t>(offset, 0, static_cast<std::ptrdiff_t>(bytes_.size()));
    return 1 + static_cast<std::size_t>(std::count(bytes_.begin(), bytes_.begin() + at, '\n'));
}

pugi::xml_node VtuReader::child(const pugi::xml_node& parent, const char* name) const
{
    const pugi::xml_node found = parent.child(name);
    if (!found) failAt(parent, parent.name(), " must have an element ", name);
    return found;
}

pugi::xml_node VtuReader::arrayOf(const pugi::xml_node& parent, const char* name) const
{
    const pugi::xml_node found = parent.find_child_by_attribute("DataArray", "Name", name);
    if (!found) failAt(parent, parent.name(), " must have a DataArray with the Name '", name, "'");
    return found;
}

NumberSource VtuReader::attributeOf(const pugi::xml_node& node, const char* name) const
{
    const std::string_view word = node.attribute(name).value();
    if (word.empty()) failAt(node, node.name(), " must have an attribute ", name);
    return {word, name_, lineOf(node)};
}

std::int64_t VtuReader::countOf(const pugi::xml_node& piece, const char* name) const
{
    NumberSource word = attributeOf(piece, name);
    const std::int64_t count = word.integer(name);
    // No format needs less than a bit for a number.
    const auto most = static_cast<std::int64_t>(kMostDeflated * bytes_.size());
    if (count < 1 || count > most)
        word.failHere(name, " must be in [1, ", most, "], what the file can hold, got ", count);
    return count;
}

void VtuReader::parse()
{
    appended_ = splitAppended(bytes_);
    const pugi::xml_parse_result result =
        document_.load_buffer(appended_.head.data(), appended_.head.size(), pugi::parse_default, pugi::encoding_utf8);
    // The end of the file was split off with the data.
    const bool ended = appended_.head.size() < bytes_.size() && result.status == pugi::status_end_element_mismatch;
    if (!result && !ended) file_.failAt(lineAt(result.offset), "the file must be XML: ", result.description());
    const pugi::xml_node root = document_.child("VTKFile");
    if (!root || std::string_view(root.attribute("type").value()) != "UnstructuredGrid")
        file_.failAt(1, "a .vtu file must be a VTKFile of the type UnstructuredGrid");
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

TetMesh VtuReader::read(const std::string& labels)
{
    parse();
    const pugi::xml_node grid = child(document_.child("VTKFile"), "UnstructuredGrid"), piece = child(grid, "Piece");
    if (const pugi::xml_node second = piece.next_sibling("Piece"))
        failAt(second, "the grid must have one Piece, got a second one; merge them before");
    readPoints(piece);
    readCells(piece);
    readNumbers(piece);
    addCells(cells_, labelsAmong(cells_, labels, name_), file_, mesh_);
    return resolve(mesh_, file_, file_, name_);
}

void VtuReader::readPoints(const pugi::xml_node& piece)
{
    const std::int64_t count = countOf(piece, "NumberOfPoints");
    const pugi::xml_node array = child(child(piece, "Points"), "DataArray");
    const std::vector<double> numbers = numbersOf<double>(array);
    if (numbers.size() != static_cast<std::size_t>(3 * count))
        failAt(array, "Points must have 3 numbers per point (", 3 * count, "), got ", numbers.size());
    const std::size_t place = lineOf(array);
    mesh_.nodes.reserve(static_cast<std::size_t>(count));
    for (std::int64_t i = 0; i < count; ++i) {
        const double* at = numbers.data() + 3 * i;
        if (!isFinite(Vec3{at[0], at[1], at[2]})) failAt(array, "point ", i, " must be finite");
        mesh_.nodes.push_back({i, place, {at[0], at[1], at[2]}});
    }
}

void VtuReader::readCells(const pugi::xml_node& piece)
{
    const auto count = static_cast<std::size_t>(countOf(piece, "NumberOfCells"));
    const pugi::xml_node cells = child(piece, "Cells"), connectivity = arrayOf(cells, "connectivity");
    const pugi::xml_node offsets = arrayOf(cells, "offsets"), types = arrayOf(cells, "types");
    cells_.connectivity = numbersOf<std::int64_t>(connectivity);
    cells_.offsets = numbersOf<std::int64_t>(offsets); // the ends
    cells_.types = numbersOf<std::int64_t>(types);
    for (const auto& [array, size] : {std::pair{offsets, cells_.offsets.size()}, {types, cells_.types.size()}})
        if (size != count) failAt(array, "must have one number per cell (", count, "), got ", size);
    cells_.offsets.insert(cells_.offsets.begin(), 0);
    checkOffsets(cells_, file_, lineOf(offsets));
    cells_.places.assign(count, lineOf(connectivity));
}

// Every array of one number per cell: any may be the labels.
void VtuReader::readNumbers(const pugi::xml_node& piece)
{
    for (const pugi::xml_node& array : piece.child("CellData").children("DataArray")) {
        if (array.attribute("NumberOfComponents").as_int(1) > 1) continue;
        const std::vector<double> values = numbersOf<double>(array, cells_.haveLabels());
        if (values.size() != cells_.types.size())
            failAt(array, "must have one number per cell (", cells_.types.size(), "), got ", values.size());
        CellNumbers& out = cells_.numbers.emplace_back(CellNumbers{array.attribute("Name").value(), {}});
        for (const double value : values)
            if (const std::optional<int> label = labelOf(value)) out.whole.push_back(*label);
        if (out.whole.size() < values.size()) out.whole.clear();
    }
}

template <class Number> std::vector<Number> VtuReader::numbersOf(const pugi::xml_node& array, bool loose) const
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

template <class Number> std::vector<Number> VtuReader::textOf(const pugi::xml_node& array, bool loose) const
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

template <class Raw> Raw VtuReader::rawAt(const char* at) const
{
    char raw[sizeof(Raw)];
    std::memcpy(raw, at, sizeof raw);
    if (swapped_) std::reverse(std::begin(raw), std::end(raw));
    return std::bit_cast<Raw>(raw);
}

template <class Raw, class Number> std::vector<Number> VtuReader::rawOf(const pugi::xml_node& array) const
{
    const std::string bytes = bytesOf(array);
    std::vector<Number> out;
    out.reserve(bytes.size() / sizeof(Raw));
    for (std::size_t at = 0; at + sizeof(Raw) <= bytes.size(); at += sizeof(Raw))
        out.push_back(static_cast<Number>(rawAt<Raw>(bytes.data() + at)));
    return out;
}

std::uint64_t VtuReader::sizeIn(ArrayBytes& from, const pugi::xml_node& array) const
{
    const std::string_view raw = from.take(sizeBytes_);
    if (raw.size() < sizeBytes_) failAt(array, "the data end before their size");
    return sizeBytes_ == 8 ? rawAt<std::uint64_t>(raw.data()) : rawAt<std::uint32_t>(raw.data());
}

std::string VtuReader::bytesOf(const pugi::xml_node& array) const
{
    const std::string_view format = array.attribute("format").value();
    std::string_view content = array.text().get();
    if (format == "appended") {
        NumberSource word = attributeOf(array, "offset");
        const std::int64_t offset = word.integer("offset");
        if (offset < 0 || static_cast<std::size_t>(offset) > appended_.data.size())
            failAt(array, "offset must be in [0, ", appended_.data.size(), "], the size of the appended data, got ",
                   offset);
        content = appended_.data.substr(static_cast<std::size_t>(offset));
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

std::string VtuReader::inflated(ArrayBytes& from, const pugi::xml_node& array) const
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

} // namespace

TetMesh parseVtu(std::string_view bytes, std::string_view name, const std::string& labels)
{
    return VtuReader(bytes, name).read(labels);
}

} // namespace filasofia::geometry
