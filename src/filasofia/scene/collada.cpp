#include "filasofia/scene/collada.h"

#include "filasofia/core/error.h"
#include "filasofia/core/user_file.h"
#include "filasofia/core/word.h"
#include "filasofia/math/quat.h"

#include <pugixml.hpp>

#include <charconv>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <vector>

namespace filasofia::scene {
namespace {

constexpr std::uintmax_t kMaxColladaFile = 512 << 20; // [bytes]
constexpr int kMaxNodeDepth = 64;
constexpr std::size_t kMostTriangles = 5'000'000;
constexpr double kFarthestVertex = 1e6; // [units of the file]

/// A linear map and a shift.
struct Affine {
    Mat3 linear = Mat3::identity();
    Vec3 shift = {};

    friend Affine operator*(const Affine& a, const Affine& b)
    {
        return {a.linear * b.linear, a.linear * b.shift + a.shift};
    }
};

class ColladaReader {
public:
    explicit ColladaReader(const std::filesystem::path& file) : name_(file.string())
    {
        const std::string bytes = readFile(file, name_, kMaxColladaFile);
        const pugi::xml_parse_result result =
            document_.load_buffer(bytes.data(), bytes.size(), pugi::parse_default, pugi::encoding_utf8);
        if (!result) fail(name_, ": this is no XML: ", result.description());
        root_ = document_.child("COLLADA");
        if (!root_) fail(name_, ": must begin with <COLLADA>");
    }

    geometry::TriangleMesh read()
    {
        for (const pugi::xml_node library : root_.children("library_geometries"))
            for (const pugi::xml_node each : library.children("geometry")) geometries_[idOf(each)] = each;
        for (const pugi::xml_node library : root_.children("library_nodes"))
            for (const pugi::xml_node each : library.children("node")) nodes_[idOf(each)] = each;
        double metre = 1.0;
        if (const auto unit = root_.child("asset").child("unit").attribute("meter")) {
            const std::vector<double> value = numbers(unit.value(), 1);
            metre = value.size() == 1 ? value[0] : 0.0;
            if (!(metre > 1e-9 && metre < 1e9)) fail(name_, ": asset/unit.meter must be in (1e-9, 1e9)");
        }
        const Affine scale{metre * Mat3::identity(), {}};
        for (const pugi::xml_node library : root_.children("library_visual_scenes"))
            for (const pugi::xml_node scene : library.children("visual_scene"))
                for (const pugi::xml_node each : scene.children("node")) addNode(each, scale, 0);
        if (out_.triangles.empty()) fail(name_, ": must have at least 1 triangle, got 0");
        geometry::check(out_, name_);
        return std::move(out_);
    }

private:
    static std::string idOf(const pugi::xml_node& node) { return node.attribute("id").value(); }

    /// The numbers of a list, at most `most`.
    std::vector<double> numbers(std::string_view words, std::size_t most) const
    {
        std::vector<double> values;
        constexpr std::string_view blanks = " \t\r\n";
        for (std::size_t at = words.find_first_not_of(blanks); at != std::string_view::npos;) {
            double value = 0.0;
            const auto [end, problem] = std::from_chars(words.data() + at, words.data() + words.size(), value);
            if (problem != std::errc{} || !std::isfinite(value) || std::abs(value) > 1e12)
                fail(name_, ": numbers must be finite, got '", shortened(words.substr(at, 40)), "'");
            if (values.size() == most) fail(name_, ": a list must have at most ", most, " numbers");
            values.push_back(value);
            at = words.find_first_not_of(blanks, static_cast<std::size_t>(end - words.data()));
        }
        return values;
    }
    static std::size_t whole(const pugi::xml_attribute& attribute, std::size_t standard)
    {
        return attribute ? static_cast<std::size_t>(attribute.as_ullong()) : standard;
    }

    /// One <matrix>, <translate>, <rotate> or <scale>.
    [[nodiscard]] std::optional<Affine> stepOf(const pugi::xml_node& node) const
    {
        const std::string_view kind = node.name();
        const std::size_t count = kind == "matrix"                         ? 16
                                  : kind == "rotate"                       ? 4
                                  : kind == "translate" || kind == "scale" ? 3
                                                                           : 0;
        if (count == 0) return {};
        const std::vector<double> v = numbers(node.child_value(), count);
        if (v.size() != count) fail(name_, ": <", kind, "> must be ", count, " numbers, got ", v.size());
        if (count == 16)
            return Affine{{{{v[0], v[1], v[2]}, {v[4], v[5], v[6]}, {v[8], v[9], v[10]}}}, {v[3], v[7], v[11]}};
        if (count == 4) return Affine{toMat3(axisAngle({v[0], v[1], v[2]}, v[3] * std::numbers::pi / 180.0)), {}};
        if (kind == "scale") return Affine{Mat3::diagonal({v[0], v[1], v[2]}), {}};
        return Affine{Mat3::identity(), {v[0], v[1], v[2]}};
    }

    void addNode(const pugi::xml_node& node, Affine at, int depth)
    {
        if (depth > kMaxNodeDepth) fail(name_, ": nodes are nested more than ", kMaxNodeDepth, " deep");
        if (++placed_ > 100'000) fail(name_, ": must have at most 100000 nodes, with those that are used again");
        for (const pugi::xml_node inner : node.children()) {
            const std::string_view kind = inner.name();
            const std::string url = inner.attribute("url").value();
            const std::string target = url.starts_with('#') ? url.substr(1) : url;
            if (const auto step = stepOf(inner)) {
                at = at * *step;
            } else if (kind == "node") {
                addNode(inner, at, depth + 1);
            } else if (kind == "instance_node") {
                const auto found = nodes_.find(target);
                if (found == nodes_.end()) fail(name_, ": there is no node '", shortened(target), "'");
                addNode(found->second, at, depth + 1);
            } else if (kind == "skew" || kind == "lookat" || kind == "instance_controller") {
                fail(name_, ": <", kind, "> is not read: a node must be placed by matrix, rotate, scale or translate");
            } else if (kind == "instance_geometry") {
                const auto found = geometries_.find(target);
                if (found == geometries_.end()) fail(name_, ": there is no geometry '", shortened(target), "'");
                addMesh(found->second.child("mesh"), at);
            }
        }
    }

    /// The positions of a mesh, by the id of its <vertices>.
    [[nodiscard]] std::vector<Vec3> positionsOf(const pugi::xml_node& mesh) const
    {
        for (const pugi::xml_node input : mesh.child("vertices").children("input")) {
            if (std::string_view(input.attribute("semantic").value()) != "POSITION") continue;
            const std::string_view id = input.attribute("source").value();
            for (const pugi::xml_node source : mesh.children("source")) {
                if (id != "#" + idOf(source)) continue;
                const pugi::xml_node accessor = source.child("technique_common").child("accessor");
                const std::size_t stride = whole(accessor.attribute("stride"), 3);
                const std::vector<double> v = numbers(source.child("float_array").child_value(), 3 * kMostTriangles);
                if (stride < 3 || stride > 100)
                    fail(name_, ": a stride of positions must be in [3, 100], got ", stride);
                std::vector<Vec3> points;
                for (std::size_t i = 0; i + 2 < v.size(); i += stride) {
                    points.push_back({v[i], v[i + 1], v[i + 2]});
                    if (length(points.back()) > kFarthestVertex)
                        fail(name_, ": a vertex must be at most ", kFarthestVertex, " from the origin");
                }
                return points;
            }
        }
        fail(name_, ": a mesh must have positions");
    }

    void addMesh(const pugi::xml_node& mesh, const Affine& at)
    {
        if (!mesh) return; // splines and convex hulls
        const std::vector<Vec3> points = positionsOf(mesh);
        const auto first = static_cast<int>(out_.vertices.size());
        if (out_.vertices.size() + points.size() > 3 * kMostTriangles)
            fail(name_, ": must have at most ", 3 * kMostTriangles, " vertices");
        for (const Vec3& each : points) {
            const Vec3 vertex = at.linear * each + at.shift;
            if (!isFinite(vertex)) fail(name_, ": a vertex must be finite, where its nodes place it");
            out_.vertices.push_back(vertex);
        }
        mirrored_ = determinant(at.linear) < 0.0;
        for (const pugi::xml_node part : mesh.children()) {
            const std::string_view kind = part.name();
            if (kind == "tristrips" || kind == "trifans")
                fail(name_, ": a mesh must consist of triangles, a polylist or polygons, got <", kind, ">");
            if (kind != "triangles" && kind != "polylist" && kind != "polygons") continue;
            addPart(part, first, points.size());
        }
    }

    void addPart(const pugi::xml_node& part, int first, std::size_t points)
    {
        std::size_t step = 1, offset = 0;
        for (const pugi::xml_node input : part.children("input")) {
            const std::size_t own = whole(input.attribute("offset"), 0);
            if (own > 100) fail(name_, ": an offset must be in [0, 100], got ", own);
            step = std::max(step, own + 1);
            if (std::string_view(input.attribute("semantic").value()) == "VERTEX") offset = own;
        }
        const std::vector<double> counts = numbers(part.child("vcount").child_value(), kMostTriangles);
        for (const pugi::xml_node list : part.children("p")) {
            const std::vector<double> v = numbers(list.child_value(), 30 * kMostTriangles);
            const std::size_t corners = v.size() / step;
            const bool polygon = std::string_view(part.name()) == "polygons";
            std::size_t at = 0;
            for (std::size_t k = 0; at < corners; ++k) {
                const double given = polygon             ? static_cast<double>(corners)
                                     : counts.empty()    ? 3.0
                                     : k < counts.size() ? counts[k]
                                                         : 0.0;
                if (!(given >= 1.0 && given <= static_cast<double>(corners - at)))
                    fail(name_, ": the corners of a <", part.name(), "> must be as many as its polygons have");
                const auto count = static_cast<std::size_t>(given);
                const auto vertex = [&](std::size_t corner) {
                    const double index = v[(at + corner) * step + offset];
                    if (!(index >= 0.0 && index < static_cast<double>(points)))
                        fail(name_, ": a face names vertex ", index, "; it must be in [0, ", points, ")");
                    return first + static_cast<int>(index);
                };
                for (std::size_t c = 1; c + 1 < count; ++c) addTriangle(vertex(0), vertex(c), vertex(c + 1));
                at += count;
            }
        }
    }
    void addTriangle(int a, int b, int c)
    {
        if (a == b || b == c || c == a) return;
        if (out_.triangles.size() == kMostTriangles) fail(name_, ": must have at most ", kMostTriangles, " triangles");
        out_.triangles.push_back(mirrored_ ? geometry::Triangle{a, c, b} : geometry::Triangle{a, b, c});
    }

    std::string name_;
    pugi::xml_document document_;
    pugi::xml_node root_;
    std::map<std::string, pugi::xml_node> geometries_, nodes_;
    geometry::TriangleMesh out_;
    std::size_t placed_ = 0;
    bool mirrored_ = false;
};

} // namespace

geometry::TriangleMesh loadCollada(const std::filesystem::path& file) { return ColladaReader(file).read(); }

} // namespace filasofia::scene
