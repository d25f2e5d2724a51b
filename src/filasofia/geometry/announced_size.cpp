#include "filasofia/geometry/announced_size.h"

#include "filasofia/core/error.h"
#include "filasofia/geometry/number_source.h"
#include "filasofia/geometry/ply_walk.h"

#include <charconv>
#include <cstdint>

namespace filasofia::geometry {
namespace {

// A line "solid NAME" begins a part; behind "vertex" stand three numbers.
void checkStlText(std::string_view bytes, std::string_view name)
{
    NumberSource in(bytes, name);
    for (std::string_view word = in.word(); !word.empty(); word = in.word()) {
        const std::string keyword = lowered(word);
        if (keyword == "solid" || keyword == "endsolid") in.restOfLine();
        if (keyword != "vertex") continue;
        for (int axis = 0; axis < 3; ++axis) in.real("a vertex's coordinate");
    }
}

// A binary STL has a header of 80 bytes, the number of triangles, and 50 bytes per triangle. A text file begins with
// "solid" and ends with "endsolid", but some binary files begin with "solid" too: then the size decides.
void checkStl(std::string_view bytes, std::string_view name)
{
    constexpr std::uint64_t kHeader = 84, kTriangle = 50;
    const bool solid = bytes.starts_with("solid");
    if (bytes.size() < kHeader && !solid)
        fail(name, ": a binary STL file must have at least 84 bytes, got ", bytes.size());
    std::uint32_t count = 0;
    if (bytes.size() >= kHeader)
        for (int i = 3; i >= 0; --i) count = count << 8 | static_cast<unsigned char>(bytes[80 + i]);
    if (solid && (bytes.size() < kHeader || bytes.size() != kHeader + kTriangle * count)) {
        const std::size_t end = bytes.rfind("endsolid"), lastFacet = bytes.rfind("endfacet");
        if (end == std::string_view::npos || (lastFacet != std::string_view::npos && end < lastFacet))
            fail(name, ": the file ends before endsolid");
        return checkStlText(bytes, name);
    }
    if (bytes.size() != kHeader + kTriangle * count && lowered(bytes.substr(0, 6)) == "solid ")
        fail(name, ": a text STL file must begin with 'solid' in lower case, got '", bytes.substr(0, 5), "'");
    const std::uint64_t max = (bytes.size() - kHeader) / kTriangle;
    if (count > max)
        fail(name, ": byte 80: the number of triangles must be in [0, ", max, "] (the file holds no more), got ",
             count);
}

// The value of the JSON member whose quoted key ends at `at`, if it is a plain number.
double numberBehind(std::string_view json, std::size_t at)
{
    at = json.find_first_not_of(" \t\r\n:", at);
    double value = 0.0;
    if (at != std::string_view::npos) std::from_chars(json.data() + at, json.data() + json.size(), value);
    return value;
}

std::uintmax_t sizeOfBuffers(const std::filesystem::path& file, std::string_view json)
{
    std::uintmax_t sum = 0;
    constexpr std::string_view kKey = "\"uri\"";
    for (std::size_t at = json.find(kKey); at != std::string_view::npos; at = json.find(kKey, at + 1)) {
        const std::size_t open = json.find('"', at + kKey.size());
        const std::size_t close = open == std::string_view::npos ? open : json.find('"', open + 1);
        if (close == std::string_view::npos || close - open > 1000)
            continue; // embedded data is already counted with the file itself
        std::error_code missing;
        const auto size = std::filesystem::file_size(
            file.parent_path() / std::filesystem::path(json.substr(open + 1, close - open - 1)), missing);
        if (!missing) sum += size;
    }
    return sum;
}

// Not a parser: every count and length of the JSON text, wherever it stands, is compared with the total number of
// bytes.
void checkGltf(const std::filesystem::path& file, std::string_view bytes)
{
    const double max = static_cast<double>(bytes.size() + sizeOfBuffers(file, bytes));
    for (std::string_view key : {"\"count\"", "\"byteLength\"", "\"byteOffset\"", "\"byteStride\""})
        for (std::size_t at = bytes.find(key); at != std::string_view::npos; at = bytes.find(key, at + 1))
            if (const double value = numberBehind(bytes, at + key.size()); !(value >= 0.0 && value <= max))
                fail(file.string(), ": byte ", at, ": ", key, " must be in [0, ", max,
                     "] (the file and its buffers hold no more), got ", value);
}

} // namespace

void checkAnnouncedSizes(const std::filesystem::path& file, std::string_view extension, std::string_view bytes)
{
    if (extension == ".ply") walkPly(bytes, file.string());
    if (extension == ".stl") checkStl(bytes, file.string());
    if (extension == ".gltf" || extension == ".glb") checkGltf(file, bytes);
}

} // namespace filasofia::geometry
