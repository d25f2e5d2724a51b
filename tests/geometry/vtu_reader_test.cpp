#include "filasofia/geometry/vtu_reader.h"

#include "geometry/sample_meshes.h"

#include <bit>
#include <cstring>
#include <zlib.h>

namespace vtu_reader_test {

using namespace filasofia;
using namespace filasofia::geometry;
using Catch::Matchers::Contains;

namespace {

std::string errorIn(std::string_view bytes)
{
    return errorOf([&] { parseVtu(bytes, "a.vtu"); });
}

std::string base64(std::string_view bytes)
{
    constexpr std::string_view symbols = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t bits = 0;
        for (std::size_t k = 0; k < 3; ++k)
            bits = bits << 8u | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        for (unsigned k = 0; k < 4; ++k) out += i + k > bytes.size() ? '=' : symbols[bits >> (18u - 6u * k) & 63u];
    }
    return out;
}

enum class Place { Text, Inline, Appended, AppendedBase64 };
struct VtuForm {
    Place place = Place::Text;
    bool deflated = false, wide = false, swapped = false;
    bool apart = true; ///< sizes and data are two pieces of base64
};

/// Writes what VTK and others write: a triangle, then the tetrahedra, with a list of values before the labels.
class VtuWriter {
public:
    explicit VtuWriter(VtuForm form) : form_(form) {}

    std::string write(const TetMesh& mesh)
    {
        std::vector<double> points, quality(mesh.tetrahedra.size() + 1, 0.25);
        for (const Vec3& p : mesh.nodes) points.insert(points.end(), {p.x, p.y, p.z});
        std::vector<std::int64_t> connectivity{0, 1, 2}, ends{3};
        std::vector<std::uint8_t> types{5};
        for (const Tetrahedron& t : mesh.tetrahedra) {
            connectivity.insert(connectivity.end(), t.begin(), t.end());
            ends.push_back(ends.back() + 4);
            types.push_back(10);
        }
        std::vector<std::int32_t> labels{-1};
        labels.insert(labels.end(), mesh.labels.begin(), mesh.labels.end());
        const bool little = (std::endian::native == std::endian::little) != form_.swapped;
        std::string out =
            text("<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"",
                 little ? "LittleEndian" : "BigEndian", "\" header_type=\"", form_.wide ? "UInt64" : "UInt32", "\"",
                 form_.deflated ? " compressor=\"vtkZLibDataCompressor\"" : "",
                 ">\n<UnstructuredGrid>\n<!-- a comment -->\n<Piece NumberOfPoints=\"", mesh.nodes.size(),
                 "\" NumberOfCells=\"", types.size(), "\">\n<PointData/>\n<CellData>\n");
        out += array("Float64", "quality", quality) + array("Int32", "part", labels) + "</CellData>\n<Points>\n";
        out +=
            array("Float64", "Points", points) + "</Points>\n<Cells>\n" + array("Int64", "connectivity", connectivity);
        out += array("Int64", "offsets", ends) + array("UInt8", "types", types);
        out += "</Cells>\n</Piece>\n</UnstructuredGrid>\n";
        if (form_.place == Place::Appended)
            out += "<AppendedData encoding=\"raw\">\n_" + appended_ + "\n</AppendedData>\n";
        if (form_.place == Place::AppendedBase64)
            out += "<AppendedData encoding=\"base64\">\n_" + appended_ + "\n</AppendedData>\n";
        return out + "</VTKFile>\n";
    }

private:
    template <class Number> void put(Number number, std::string& to) const
    {
        char raw[sizeof number];
        std::memcpy(raw, &number, sizeof number);
        if (form_.swapped) std::reverse(raw, raw + sizeof number);
        to.append(raw, sizeof number);
    }
    void putSize(std::size_t size, std::string& to) const
    {
        form_.wide ? put(static_cast<std::uint64_t>(size), to) : put(static_cast<std::uint32_t>(size), to);
    }

    template <class Number> std::string array(const char* type, const char* name, const std::vector<Number>& numbers)
    {
        const std::string head = text("<DataArray type=\"", type, "\" Name=\"", name, "\"");
        if (form_.place == Place::Text) {
            std::string out = head + " format=\"ascii\">\n<InformationKey name=\"L2\">1</InformationKey>\n";
            for (const Number number : numbers) out += text(+number, "\n");
            return out + "</DataArray>\n";
        }
        std::string raw, sizes, data;
        for (const Number number : numbers) put(number, raw);
        if (form_.deflated) { // in blocks of 100 bytes
            const std::size_t blocks = (raw.size() + 99) / 100;
            putSize(blocks, sizes), putSize(100, sizes), putSize(raw.size() % 100, sizes);
            for (std::size_t k = 0; k < blocks; ++k) {
                const std::string block = raw.substr(100 * k, 100);
                std::string packed(compressBound(block.size()), '\0');
                uLongf size = packed.size();
                compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(block.data()),
                         block.size());
                putSize(size, sizes);
                data.append(packed, 0, size);
            }
        } else {
            putSize(raw.size(), sizes);
            data = raw;
        }
        const std::string coded = form_.place == Place::Appended ? sizes + data
                                  : form_.apart                  ? base64(sizes) + base64(data)
                                                                 : base64(sizes + data);
        if (form_.place == Place::Inline) return head + " format=\"binary\">\n  " + coded + "\n</DataArray>\n";
        const std::size_t offset = appended_.size();
        appended_ += coded;
        return head + text(" format=\"appended\" offset=\"", offset, "\"/>\n");
    }

    VtuForm form_;
    std::string appended_;
};

std::vector<VtuForm> allForms()
{
    std::vector<VtuForm> all{{}};
    for (const Place place : {Place::Inline, Place::Appended, Place::AppendedBase64})
        for (const bool deflated : {false, true})
            for (const bool wide : {false, true})
                for (const bool swapped : {false, true})
                    for (const bool apart : {false, true}) all.push_back({place, deflated, wide, swapped, apart});
    return all;
}

const std::string kFile =
    "<VTKFile type=\"UnstructuredGrid\">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\"4\" NumberOfCells=\"1\">\n"
    "<Points><DataArray type=\"Float32\" format=\"ascii\">\n0 0 0 1 0 0\n0 1 0 0 0 1\n</DataArray></Points>\n"
    "<Cells><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">\n0 1 2 3</DataArray>\n"
    "<DataArray type=\"Int32\" Name=\"offsets\">4</DataArray>\n"
    "<DataArray type=\"UInt8\" Name=\"types\">10</DataArray></Cells>\n</Piece>\n</UnstructuredGrid></VTKFile>\n";

} // namespace

TEST_CASE("a mesh with labels comes back from every form of VTK's XML files, bit for bit")
{
    const TetMesh mesh = labelledCube(3);
    for (const VtuForm form : allForms()) {
        const std::string file = VtuWriter(form).write(mesh);
        CHECK(parseVtuSurface(file, "a.vtu").triangles == std::vector<Triangle>{{0, 1, 2}}); // what is no solid
        const TetMesh read = parseVtu(file, "a.vtu");
        CHECK(read.nodes == mesh.nodes);
        CHECK(read.tetrahedra == mesh.tetrahedra);
        CHECK(read.labels == mesh.labels);
    }
    CHECK(parseVtu(VtuWriter({}).write(mesh), "a.vtu", "part").labels == mesh.labels);
    CHECK_THAT(errorOf([&] { parseVtu(VtuWriter({}).write(mesh), "a.vtu", "organ"); }),
               Contains("got 'organ', which the file does not have; its lists: 'part'"));
    CHECK(parseVtu(kFile, "a.vtu").labels.empty());
    CHECK(parseVtu(kFile, "a.vtu").tetrahedra == unitTetrahedron().tetrahedra);
}

TEST_CASE("what is wrong in a VTK XML file is named with its line")
{
    CHECK_THAT(errorIn("solid cube"), Contains("a.vtu:1: the file must be XML"));
    CHECK_THAT(errorIn(kFile.substr(0, 200)), Contains("the file must be XML"));
    CHECK_THAT(errorIn(replaced(kFile, "\"UnstructuredGrid\"", "\"PolyData\"")),
               Contains("a.vtu:1: a .vtu file must be a VTKFile of the type UnstructuredGrid"));
    const std::string other = replaced(kFile, "<VTKFile", "<VTKFile compressor=\"vtkLZ4DataCompressor\"");
    CHECK(errorIn(other).empty()); // nothing is compressed
    CHECK_THAT(errorIn(replaced(other, "ascii\">\n0 1 2 3", "binary\">\nAAAA")),
               Contains("a.vtu:8: the data must be compressed by vtkZLibDataCompressor or not at all, got "
                        "'vtkLZ4DataCompressor'"));
    CHECK_THAT(errorIn(replaced(kFile, "<VTKFile", "<VTKFile byte_order=\"Middle\"")), Contains("byte_order must be"));
    CHECK_THAT(errorIn(replaced(kFile, "<VTKFile", "<VTKFile header_type=\"Int8\"")), Contains("header_type must be"));
    CHECK_THAT(errorIn(replaced(kFile, "=\"4\"", "=\"5\"")),
               Contains("a.vtu:4: Points must have 3 numbers per point (15), got 12"));
    CHECK_THAT(errorIn(replaced(kFile, "=\"4\"", "=\"-4\"")), Contains("a.vtu:3: NumberOfPoints must be in [1, "));
    CHECK_THAT(errorIn(replaced(kFile, "=\"4\"", "=\"99999999999\"")), Contains("a.vtu:3: NumberOfPoints must be in "));
    CHECK_THAT(errorIn(replaced(kFile, "NumberOfPoints=\"4\"", "")),
               Contains("a.vtu:3: Piece must have an attribute NumberOfPoints"));
    CHECK_THAT(errorIn(replaced(kFile, "1 0 0\n", "1 nan 0\n")), Contains("a.vtu:5: a number must be finite"));
    CHECK_THAT(errorIn(replaced(kFile, "connectivity", "cells")),
               Contains("a.vtu:8: Cells must have a DataArray with the Name 'connectivity'"));
    CHECK_THAT(errorIn(replaced(kFile, "0 1 2 3", "0 1 2 9")), Contains("a.vtu:8: tetrahedron 0 names node 9"));
    CHECK_THAT(errorIn(replaced(kFile, "0 1 2 3", "0 1 2 2.5")), Contains("a.vtu:9: a number must be a whole number"));
    CHECK_THAT(errorIn(replaced(kFile, ">4<", ">5<")), Contains("a.vtu:10: the offsets of cells must ascend"));
    CHECK_THAT(errorIn(replaced(kFile, ">10<", ">10 10<")),
               Contains("a.vtu:11: must have one number per cell (1), got 2"));
    CHECK_THAT(errorIn(replaced(kFile, ">10<", ">25<")),
               Contains("cell 0 must be a tetrahedron of 4 or 10 nodes, or a hexahedron"));
    CHECK_THAT(errorIn(replaced(kFile, "</Piece>", "</Piece>\n<Piece/>")),
               Contains("a.vtu:13: the grid must have one Piece, got a second one"));
    CHECK_THAT(errorIn(replaced(kFile, "ascii\">\n0 1 2 3", "binary\">\n!")), Contains("a.vtu:8: the data end before"));
    CHECK_THAT(errorIn(replaced(kFile, "ascii\">\n0 1 2 3", "octal\">\n7")), Contains("a.vtu:8: format must be ascii"));
    const std::string deflated = VtuWriter({.place = Place::Appended, .deflated = true}).write(labelledCube(1));
    std::string damaged = deflated;
    damaged[deflated.find('_', deflated.find("<AppendedData")) + 60] ^= 0x55;
    CHECK_THAT(errorIn(damaged), Contains("a.vtu:"));
}

TEST_CASE("a VTK XML file may be cut off anywhere and any byte may be wrong: nothing but a mesh or an Error comes out")
{
    const auto parse = [](const std::string& bytes) { return parseVtu(bytes, "a.vtu"); };
    for (const VtuForm form : {VtuForm{}, VtuForm{Place::Inline}, VtuForm{Place::Appended, true, true},
                               VtuForm{Place::AppendedBase64, true, false, true}})
        damage(VtuWriter(form).write(labelledCube(1)), "a.vtu", parse);
}

} // namespace vtu_reader_test
