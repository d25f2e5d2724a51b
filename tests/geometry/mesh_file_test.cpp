#include "filasofia/geometry/mesh_file.h"
#include "filasofia/geometry/texture_seams.h"
#include "geometry/gmsh_writer.h"
#include "geometry/sample_meshes.h"

#include <sys/stat.h>

namespace mesh_file_test {

using namespace filasofia;
using namespace filasofia::geometry;
using Catch::Matchers::Contains;
using Catch::Matchers::EndsWith;

namespace {

std::string errorFor(const std::string& name, std::string_view bytes)
{
    const TemporaryFile file(name, bytes);
    return errorOf([&] { loadTriangleMesh(file.path()); });
}

TriangleMesh meshFrom(const std::string& name, std::string_view bytes)
{
    const TemporaryFile file(name, bytes);
    return loadTriangleMesh(file.path());
}

void putRaw(std::string& out, const auto& value) { out.append(reinterpret_cast<const char*>(&value), sizeof value); }

// The unit tetrahedron's surface in each format.
std::string obj() { return "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 2 3 4\nf 1 4 3\nf 1 2 4\nf 1 3 2\n"; }
std::string asciiStl(const TriangleMesh& mesh)
{
    std::string out = "solid tetrahedron\n";
    for (const Triangle& t : mesh.triangles) {
        out += "facet normal 0 0 0\nouter loop\n";
        for (int i : t)
            out += text("vertex ", mesh.vertices[i].x, ' ', mesh.vertices[i].y, ' ', mesh.vertices[i].z, '\n');
        out += "endloop\nendfacet\n";
    }
    return out + "endsolid tetrahedron\n";
}
std::string binaryStl(const TriangleMesh& mesh, std::uint32_t announced)
{
    std::string out(80, ' ');
    putRaw(out, announced);
    for (const Triangle& t : mesh.triangles) {
        for (int i = 0; i < 3; ++i) putRaw(out, 0.0F);
        for (int i : t)
            for (int axis = 0; axis < 3; ++axis) putRaw(out, static_cast<float>(mesh.vertices[i][axis]));
        out.append(2, '\0');
    }
    return out;
}
std::string ply(std::string_view vertices = "4", std::string_view faces = "4")
{
    return text("ply\nformat ascii 1.0\nelement vertex ", vertices,
                "\nproperty float x\nproperty float y\nproperty float z\nelement face ", faces,
                "\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
                "3 1 2 3\n3 0 3 2\n3 0 1 3\n3 0 2 1\n");
}
std::string binaryPly(bool bigEndian)
{
    std::string out = text("ply\nformat binary_", bigEndian ? "big" : "little",
                           "_endian 1.0\ncomment element vertex 99999999\nelement vertex 4\nproperty double "
                           "x\nproperty double y\nproperty double z\n"
                           "element face 4\nproperty list uint8 uint16 vertex_indices\nend_header\n");
    const auto put = [&](auto value) {
        std::string raw;
        putRaw(raw, value);
        if (bigEndian) std::ranges::reverse(raw);
        out += raw;
    };
    for (Vec3 p : unitTetrahedron().nodes) put(p.x), put(p.y), put(p.z);
    for (const auto& face : kTetrahedronFaces) {
        put(std::uint8_t{3});
        for (int i : face) put(static_cast<std::uint16_t>(i));
    }
    return out;
}
// The four corners as floats, then the twelve indices; `nodes` places mesh 0.
std::string gltf(std::string_view nodes, std::string_view count = "4",
                 std::string_view uri = R"(,"uri":"tetrahedron.bin")")
{
    return text(R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[)", nodes,
                R"(],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
                "accessors":[{"bufferView":0,"componentType":5126,"count":)",
                count,
                R"(,"type":"VEC3","min":[0,0,0],"max":[1,1,1]},
                {"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"}],
                "bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":24}],
                "buffers":[{"byteLength":72)",
                uri, "}]}");
}
std::string gltfBuffer()
{
    std::string out;
    for (Vec3 p : unitTetrahedron().nodes)
        for (int axis = 0; axis < 3; ++axis) putRaw(out, static_cast<float>(p[axis]));
    for (const auto& face : kTetrahedronFaces)
        for (int i : face) putRaw(out, static_cast<std::uint16_t>(i));
    return out;
}

std::string glb()
{
    std::string json = gltf(R"({"mesh":0})", "4", ""), out = "glTF";
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const std::string buffer = gltfBuffer();
    for (std::size_t number : {std::size_t{2}, 28 + json.size() + buffer.size(), json.size()})
        putRaw(out, static_cast<std::uint32_t>(number));
    out += "JSON" + json;
    putRaw(out, static_cast<std::uint32_t>(buffer.size()));
    return out + std::string("BIN\0", 4) + buffer;
}

void checkIsUnitTetrahedron(const TriangleMesh& mesh)
{
    CHECK(mesh.vertices.size() == 4);
    CHECK(mesh.triangles.size() == 4);
    CHECK(isClosedManifold(mesh));
    CHECK(volumeInside(mesh) == Approx(1.0 / 6.0));
    CHECK(mesh.uv.empty());
}

} // namespace

TEST_CASE("the same surface comes from OBJ, STL, PLY and glTF")
{
    const LogTrap log;
    const TriangleMesh surface = extractSurface(unitTetrahedron()).mesh;
    checkIsUnitTetrahedron(meshFrom("t.obj", obj()));
    checkIsUnitTetrahedron(meshFrom("t.OBJ", obj()));
    checkIsUnitTetrahedron(meshFrom("t.stl", asciiStl(surface)));
    checkIsUnitTetrahedron(meshFrom("t.stl", binaryStl(surface, 4)));
    checkIsUnitTetrahedron(meshFrom("t.ply", ply()));
    for (bool bigEndian : {false, true}) checkIsUnitTetrahedron(meshFrom("t.ply", binaryPly(bigEndian)));
    checkIsUnitTetrahedron(meshFrom("t.glb", glb()));
    const TemporaryFile buffer("tetrahedron.bin", gltfBuffer());
    checkIsUnitTetrahedron(meshFrom("t.gltf", gltf(R"({"mesh":0})")));
    CHECK(log.lines.empty());
}

TEST_CASE("nodes place their meshes, and a mirroring node does not turn its mesh inside out")
{
    const TemporaryFile buffer("tetrahedron.bin", gltfBuffer());
    const TriangleMesh moved =
        meshFrom("t.gltf", gltf(R"({"children":[1],"translation":[10,0,0]},{"mesh":0,"scale":[2,2,2]})"));
    CHECK(moved.vertices.size() == 4);
    CHECK(volumeInside(moved) == Approx(8.0 / 6.0));
    for (Vec3 p : moved.vertices) CHECK(p.x >= 10.0);
    const TriangleMesh mirrored = meshFrom("t.gltf", gltf(R"({"mesh":0,"scale":[-1,1,1]})"));
    CHECK(isClosedManifold(mirrored));
    CHECK(volumeInside(mirrored) == Approx(1.0 / 6.0));
    const TriangleMesh twice =
        meshFrom("t.gltf", gltf(R"({"mesh":0,"children":[1]},{"mesh":0,"translation":[5,0,0]})"));
    CHECK(twice.vertices.size() == 8);
    CHECK(volumeInside(twice) == Approx(2.0 / 6.0));
}

TEST_CASE("parts of one file become one mesh, and polygons become triangles")
{
    const TriangleMesh cube = meshFrom(
        "t.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
                 "o bottom\nf 4 3 2 1\no top\nf 5 6 7 8\no sides\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
    CHECK(cube.vertices.size() == 8);
    CHECK(cube.triangles.size() == 12);
    CHECK(isClosedManifold(cube));
    CHECK(volumeInside(cube) == Approx(1.0));
    CHECK(cube.vertices[0] == Vec3{0, 1, 0}); // in the order in which faces use them
    CHECK(cube.vertices[1] == Vec3{1, 1, 0});
}

TEST_CASE("texture coordinates come along, one pair per vertex, or per corner if there is a seam")
{
    const LogTrap log;
    const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0.25\nvt 1 0\nvt 0 1\nvt 0.5 0.5\n";
    const TriangleMesh plain = meshFrom("t.obj", points + "f 1/1 2/2 3/3\nf 3/3 2/2 4/4\n");
    CHECK(plain.uv == std::vector<std::array<double, 2>>{{0, 0.25}, {1, 0}, {0, 1}, {0.5, 0.5}});
    CHECK_FALSE(perCorner(plain));

    const TriangleMesh seam = meshFrom("t.obj", points + "f 1/1 2/2 3/3\nf 3/3 2/4 4/4\n");
    CHECK(seam.vertices.size() == 4);
    REQUIRE(perCorner(seam));
    CHECK(seam.uv == std::vector<std::array<double, 2>>{{0, 0.25}, {1, 0}, {0, 1}, {0, 1}, {0.5, 0.5}, {0.5, 0.5}});
    CHECK(uvOfVertices(seam) == std::vector<std::array<double, 2>>{{0, 0.25}, {1, 0}, {0, 1}, {0.5, 0.5}});
    CHECK(log.lines.empty()); // most files have seams
}

TEST_CASE("pairs of corners become pairs of vertices if there are as many of these")
{
    TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{2, 0, 1}}, {}};
    setUvOfCorners(mesh, {{0.2, 0}, {0, 0}, {0.1, 0}});
    CHECK(mesh.uv == std::vector<std::array<double, 2>>{{0, 0}, {0.1, 0}, {0.2, 0}});
    mesh.vertices.push_back({1, 1, 1});
    setUvOfCorners(mesh, {{0.2, 0}, {0, 0}, {0.1, 0}});
    CHECK(perCorner(mesh));
    CHECK(uvOfVertices(mesh)[2] == std::array{0.2, 0.0});
    mesh.uv.pop_back();
    CHECK_THAT(errorOf([&] { check(mesh, "sheet"); }),
               Contains("sheet: uv must be empty or have one pair for each of 4 vertices or of 3 corners, got 2"));
}

TEST_CASE("triangles that collapse in joining are dropped and counted in one warning")
{
    const LogTrap log;
    const TriangleMesh mesh = meshFrom("t.obj", obj() + "v 0 0 0\nf 1 5 2\nf 1 2 2\n");
    checkIsUnitTetrahedron(mesh);
    CHECK_THAT(log.lines, Contains("t.obj: dropped 2 triangles with two corners at the same place\n"));
    CHECK(std::ranges::count(log.lines, '\n') == 1);
}

TEST_CASE("what is no mesh file at all is refused by name")
{
    const std::filesystem::path folder = std::filesystem::path(FILASOFIA_BINARY_DIR) / "test_files" / "folder.obj";
    std::filesystem::create_directories(folder);
    CHECK_THAT(errorOf([&] { loadTriangleMesh(folder); }), Contains("folder.obj: must be a file, got a directory"));
    for (const auto& any : {folder, folder.parent_path(), folder.parent_path() / ""}) {
        CHECK(errorOf([&] { loadTriangleMesh(any); }) == any.string() + ": must be a file, got a directory");
        CHECK(errorOf([&] { loadTetMesh(any); }) == any.string() + ": must be a file, got a directory");
    }
    CHECK_THAT(errorOf([] { loadTetMesh("liver"); }), EndsWith(".ele file, got a name without an ending"));
    CHECK_THAT(errorOf([] { loadTriangleMesh("nowhere.obj"); }), Contains("nowhere.obj: no such file"));
    CHECK_THAT(errorOf([] { loadTetMesh("nowhere.msh"); }), Contains("nowhere.msh: no such file"));
    CHECK_THAT(errorOf([] { loadTetMesh("nowhere.node"); }), Contains("nowhere.node: no such file"));
    CHECK_THAT(errorOf([] { loadTriangleMesh("/dev/zero"); }),
               Contains("must be an .obj, .stl, .ply, .gltf, .glb, .off, .vtk, .vtp, .vtu or .mesh file"));
    CHECK_THAT(errorOf([] { loadTriangleMesh("a.fbx"); }),
               Contains("must be an .obj, .stl, .ply, .gltf, .glb, .off, .vtk, .vtp, .vtu or .mesh file, got '.fbx'"));
    CHECK_THAT(errorOf([] { loadTetMesh("a.obj"); }),
               Contains("must be a .msh, .mesh, .vtk, .vtu, .node or .ele file, got '.obj'"));
    CHECK_THAT(errorOf([] { loadTetMesh("liver"); }), Contains("liver: a tetrahedral mesh must be"));
    CHECK_THAT(errorOf([] { loadTetMesh("liver.msh", 1.0, "part"); }),
               Contains("liver.msh: labels names a list of a .vtk or .vtu file, got 'part' for a '.msh' file"));
    for (const char* name : {"e.obj", "e.stl", "e.ply", "e.gltf", "e.glb"})
        CHECK_THAT(errorFor(name, ""), Contains(std::string(name) + ": is empty"));
    const TemporaryFile empty("e.msh", "");
    CHECK_THAT(errorOf([&] { loadTetMesh(empty.path()); }), Contains("e.msh: is empty"));
}

TEST_CASE("a pipe that a mesh file names as its material is not waited for")
{
    const TemporaryFile mesh("piped.obj", "mtllib piped.mtl\n" + obj());
    const std::filesystem::path pipe = mesh.path().parent_path() / "piped.mtl";
    REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
    checkIsUnitTetrahedron(loadTriangleMesh(mesh.path()));
    std::filesystem::remove(pipe);
}

TEST_CASE("a broken surface file gives an Error that names it")
{
    const LogTrap quiet; // a skipped line or point is logged
    const TriangleMesh surface = extractSurface(unitTetrahedron()).mesh;
    for (const char* name : {"b.obj", "b.stl", "b.ply", "b.gltf", "b.glb"}) {
        CHECK_THAT(errorFor(name, "this is no mesh"), Contains(name));
        CHECK_THAT(errorFor(name, std::string(200, '\0')), Contains(name));
    }
    CHECK_THAT(errorFor("b.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"), Contains("b.obj"));
    CHECK_THAT(errorFor("b.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"),
               Contains("b.obj:4: a face names number 9 of the vertices; the file has 3"));
    CHECK_THAT(errorFor("b.obj", "v 0 0 0\nv 1 0 0\nv nan 1 0\nf 1 2 3\n"),
               Contains("b.obj:3: ") && Contains("must be finite, got 'nan'"));
    CHECK_THAT(errorFor("b.obj", "v 0 0 0\nv 1 0 0\nv 1e99 1 0\nf 1 2 3\n"),
               Contains("b.obj: vertex ") && Contains("must be finite"));
    CHECK_THAT(errorFor("b.obj", "v 0 0 0\nv 1 0 0\nv 1 0 0\nf 1 2 3\n"),
               Contains("b.obj: must have at least 1 triangle"));
    CHECK_THAT(errorFor("b.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n"), Contains("b.obj: must have at least 1 triangle"));
    for (std::size_t cut : {3, 4, 8, 12, 30})
        CHECK_THAT(errorFor("b.ply", ply().substr(0, ply().size() - cut)), Contains("b.ply:"));
    for (std::size_t cut : {1, 10, 25})
        for (bool bigEndian : {false, true})
            CHECK_THAT(errorFor("b.ply", binaryPly(bigEndian).substr(0, binaryPly(bigEndian).size() - cut)),
                       Contains("b.ply: byte ") && Contains("the file ends"));
    CHECK_THAT(errorFor("b.glb", glb().substr(0, glb().size() - 10)), Contains("b.glb"));
    CHECK_THAT(errorFor("b.stl", asciiStl(surface).substr(0, asciiStl(surface).size() - 23)),
               Contains("b.stl: the file ends before endsolid"));
    CHECK_THAT(errorFor("b.gltf", gltf(R"({"mesh":0})", "4", R"(,"uri":"nowhere.bin")")), Contains("b.gltf"));
    CHECK_THAT(errorFor("b.gltf", gltf(R"({"mesh":0,"children":[0]})")), Contains("b.gltf"));
    CHECK_THAT(errorFor("b.stl", binaryStl(surface, 4).substr(0, 200)), Contains("b.stl"));
    std::string upper = asciiStl(surface), named = binaryStl(surface, 4);
    std::ranges::transform(upper, upper.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    CHECK_THAT(errorFor("b.stl", upper),
               Contains("b.stl: a text STL file must begin with 'solid' in lower case, got 'SOLID'"));
    named.replace(0, 10, "Solid Edge"); // a binary file may have any header
    checkIsUnitTetrahedron(meshFrom("b.stl", named));
}

TEST_CASE("a number in a text file of triangles is read whole, or refused with its line")
{
    const LogTrap quiet;
    const auto file = [](std::string_view extension, std::string_view x) {
        if (extension == "obj") return text("v 0 0 0\nv ", x, " 3 0\nv 0 -3 0\nf 1 2 3\n");
        if (extension == "stl")
            return text("solid vertex\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex ", x,
                        " 3 0\nvertex 0 -3 0\nendloop\nendfacet\nendsolid vertex\n");
        if (extension == "vtk")
            return text("# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS 3 double\n0 0 0\n", x,
                        " 3 0\n0 -3 0\nPOLYGONS 1 4\n3 0 1 2\n");
        return text("ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double "
                    "z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n",
                    x, " 3 0\n0 -3 0\n3 0 1 2\n");
    };
    const std::pair<const char*, double> right[] = {{".5", 0.5},     {"-.5", -0.5},   {"+.5", 0.5}, {"+1", 1.0},
                                                    {"1e-3", 0.001}, {"1E-3", 0.001}, {"1.", 1.0},  {".25e1", 2.5}};
    for (const std::string extension : {"obj", "stl", "vtk", "ply"}) {
        const std::string name = "number." + extension;
        for (const auto& [word, value] : right)
            for (const bool windows : {false, true}) {
                std::string bytes = file(extension, word);
                for (std::size_t at = 0; windows && (at = bytes.find('\n', at)) != std::string::npos; at += 2)
                    bytes.insert(at, 1, '\r');
                const TriangleMesh mesh = meshFrom(name, bytes);
                REQUIRE(mesh.vertices.size() == 3);
                CHECK(mesh.vertices[1].x == Approx(value));
            }
        for (const char* word : {"1,5", "1d0", "0x10", "1e", "1.2.3", "--1", "1_0", "1.5f", "nan", "inf", "a"})
            CHECK_THAT(errorFor(name, file(extension, word)),
                       Contains(name + ":") && Contains(text("got '", word, "'")));
    }
}

TEST_CASE("what would make assimp end the process gives an Error")
{
    const LogTrap quiet;
    const std::string good = ply();
    const auto with = [&](std::string_view from, std::string_view to) {
        std::string bad = good;
        return bad.replace(bad.rfind(from), from.size(), to);
    };
    CHECK_THAT(errorFor("a.ply", with("3 0 2 1", "0")), Contains("a.ply"));       // a face without corners
    CHECK_THAT(errorFor("a.ply", with("3 0 2 1", "3 0 2 9")), Contains("a.ply")); // a vertex that does not exist
    CHECK_THAT(errorFor("a.ply", with("3 0 2 1", "3 0\n2 1")),
               Contains("a.ply:17: the line ends before all numbers of face"));
    CHECK_THAT(errorFor("a.ply", with("3 0 2 1", "3 0 2 1 7")),
               Contains("a.ply:17: the line has more numbers than face"));
    CHECK_THAT(errorFor("a.ply", with("3 0 2 1", "3 0 x 1")), Contains("a.ply:17: face must be a number, got 'x'"));
}

TEST_CASE("a surface file that announces more than it can hold is refused before it is read")
{
    const TriangleMesh surface = extractSurface(unitTetrahedron()).mesh;
    CHECK_THAT(errorFor("h.ply", ply("1000000000")),
               Contains("h.ply:3: the number of elements 'vertex' must be in [0, "));
    CHECK_THAT(errorFor("h.ply", ply("4", "4000000000")),
               Contains("h.ply:7: the number of elements 'face' must be in [0, "));
    CHECK_THAT(errorFor("h.stl", binaryStl(surface, 4000000000U)),
               Contains("h.stl: byte 80: the number of triangles must be in [0, 4]") && Contains("got 4000000000"));
    const TemporaryFile buffer("tetrahedron.bin", gltfBuffer());
    CHECK_THAT(errorFor("h.gltf", gltf(R"({"mesh":0})", "4000000000")),
               Contains("h.gltf: byte ") && Contains("\"count\" must be in [0, "));
    CHECK_THAT(errorFor("h.gltf", gltf(R"({"mesh":0})", "5")), Contains("h.gltf"));
}

TEST_CASE("a file in another unit is read in metres, and a scale that is no length is refused")
{
    const TemporaryFile surface("t.obj", obj()), volume("t.msh", writeGmsh(unitTetrahedron(), {}));
    const TriangleMesh triangles = loadTriangleMesh(surface.path()), small = loadTriangleMesh(surface.path(), 1e-3);
    REQUIRE(small.vertices.size() == triangles.vertices.size());
    for (std::size_t i = 0; i < small.vertices.size(); ++i) CHECK(small.vertices[i] == 1e-3 * triangles.vertices[i]);
    CHECK(small.triangles == triangles.triangles);
    const TetMesh tetrahedra = loadTetMesh(volume.path()), large = loadTetMesh(volume.path(), 25.4);
    REQUIRE(large.nodes.size() == tetrahedra.nodes.size());
    for (std::size_t i = 0; i < large.nodes.size(); ++i) CHECK(large.nodes[i] == 25.4 * tetrahedra.nodes[i]);
    for (const double scale : {0.0, -1.0, std::numeric_limits<double>::infinity()}) {
        CHECK_THAT(errorOf([&] { loadTetMesh(volume.path(), scale); }), Contains("t.msh: scale must be in (0, inf)"));
        CHECK_THAT(errorOf([&] { loadTriangleMesh(surface.path(), scale); }), Contains("t.obj: scale must be in"));
    }
}

} // namespace mesh_file_test
