#include "filasofia/scene/scene_writer.h"

#include "filasofia/core/error.h"
#include "filasofia/core/output_file.h"
#include "filasofia/core/user_file.h"
#include "filasofia/core/word.h"
#include "filasofia/geometry/mesh_file.h"
#include "filasofia/geometry/mesh_text.h"
#include "filasofia/runtime/assets.h"
#include "filasofia/scene/path_within.h"
#include "filasofia/scene/scene_file.h"

#include <cctype>
#include <limits>

namespace filasofia::scene {
namespace {

constexpr std::size_t kLineWidth = 120;

/// JSON as people write it: what fits stands on one line.
void print(std::string& out, const Written& json, std::size_t indent, std::size_t before)
{
    std::string line;
    const auto inLine = [&line](const auto& self, const Written& it) -> void {
        if (line.size() > kLineWidth) return; // it does not fit, so what follows need not be known
        if (!it.is_structured()) {
            line += it.dump();
            return;
        }
        line += it.is_array() ? '[' : '{';
        bool first = true;
        for (const auto& item : it.items()) {
            if (!std::exchange(first, false)) line += ", ";
            if (it.is_object()) line += Written(item.key()).dump() + ": ";
            self(self, item.value());
        }
        line += it.is_array() ? ']' : '}';
    };
    inLine(inLine, json);
    if (!json.is_structured() || json.empty() || before + line.size() < kLineWidth) {
        out += line;
        return;
    }
    out += json.is_array() ? '[' : '{';
    bool first = true;
    for (const auto& item : json.items()) {
        out += std::exchange(first, false) ? "\n" : ",\n";
        out.append(indent + 2, ' ');
        const std::string name = json.is_object() ? Written(item.key()).dump() + ": " : "";
        out += name;
        print(out, item.value(), indent + 2, indent + 3 + name.size());
    }
    out += '\n';
    out.append(indent, ' ');
    out += json.is_array() ? ']' : '}';
}

bool isUtf8(const std::string& words)
{
    try {
        static_cast<void>(Written(words).dump());
    } catch (const Written::exception&) {
        return false;
    }
    return true;
}

void writeFile(const std::filesystem::path& file, std::string_view bytes)
{
    OutputFile out(file);
    out.write(bytes);
    out.close();
}

/// The name of a file that comes with Filasofia; else empty.
std::string assetName(const std::filesystem::path& file)
{
    std::filesystem::path inner = file.filename();
    for (std::filesystem::path at = file.parent_path(); at.has_filename(); at = at.parent_path()) {
        try {
            std::error_code problem;
            const std::string name = inner.generic_string();
            if (std::filesystem::equivalent(runtime::asset(name), file, problem)) return name;
        } catch (const Error&) { // there is no such asset
        }
        inner = at.filename() / inner;
    }
    return {};
}

} // namespace

SceneWriter::SceneWriter(const std::filesystem::path& file)
    : folder_(std::filesystem::absolute(file).parent_path()), files_(folder_ / (file.stem().string() + "_files"))
{
}

Written SceneWriter::write(const SceneDef& scene)
{
    for (const SceneBody& body : scene.bodies)
        std::visit(
            [&](const auto& def) {
                if (!isUtf8(def.name)) fail("a body's name must be UTF-8, got '", oneLine(def.name), "'");
                bodies_.push_back(def.name);
                for (std::size_t i = 0; i < def.attachments.size(); ++i)
                    attachments_.push_back(text(def.name, ".attachments[", i, "]"));
            },
            body.def);
    for (const SceneInstrument& each : scene.instruments)
        bodies_.push_back(std::visit([](const auto& def) { return def.name; }, each.def));
    return object(scene, SceneDef{});
}

Written SceneWriter::value(const SceneBody& it, const SceneBody& base)
{
    current_ = std::visit([](const auto& def) { return def.name; }, it.def);
    return object(it, base);
}

Written SceneWriter::number(double value)
{
    if (std::isnan(value)) fail("a scene file cannot hold NaN");
    if (std::isinf(value)) return value > 0 ? record::kInfinite : record::kMinusInfinite;
    constexpr double kWhole = 1e15; // whole numbers below it are exact, and read better without ".0"
    if (value == std::trunc(value) && std::abs(value) < kWhole && !(value == 0.0 && std::signbit(value)))
        return static_cast<std::int64_t>(value);
    return value;
}

Written SceneWriter::pose(const Pose& it, const Pose& base)
{
    if (same(it.orientation, base.orientation)) return numbers(it.position);
    return {{"position", numbers(it.position)}, {"orientation", numbers(it.orientation)}};
}

Written SceneWriter::attachmentName(AttachmentId id) const
{
    if (id.value <= attachments_.size()) return attachments_[id.value - 1];
    return text("attachment ", id.value);
}

std::string SceneWriter::nameOf(const std::string& file)
{
    if (file.empty()) return file;
    if (const std::string asset = assetName(std::filesystem::absolute(file)); !asset.empty()) return "asset:" + asset;
    std::string name = pathWithin(folder_, file);
    if (!name.empty()) kept_.insert(folder_ / name);
    return name;
}

std::string SceneWriter::newFile(std::string_view name, std::string_view extension, Write write)
{
    constexpr std::size_t kLongest = 60; // letters; systems allow 255 bytes
    std::string plain;
    if (name.empty()) name = "body";
    for (const char each : name.substr(0, kLongest))
        plain += std::isalnum(static_cast<unsigned char>(each)) ? each : '_';
    std::string unused = text(plain, extension);
    for (int i = 2; kept_.contains(files_ / unused) || !taken_.insert(unused).second; ++i)
        unused = text(plain, "_", i, extension);
    new_.emplace_back(files_ / unused, std::move(write));
    return (files_.filename() / unused).generic_string();
}

void SceneWriter::writeFiles(bool overwrite) const
{
    if (new_.empty()) return;
    std::error_code problem;
    for (const auto& each : new_)
        if (!overwrite && std::filesystem::exists(std::filesystem::symlink_status(each.first, problem)))
            fail(each.first.string(), ": is there already (--force replaces it)");
    if (std::filesystem::exists(files_, problem) && pathWithin(folder_, files_).empty())
        fail(files_.string(), ": must be in the folder of the scene, also behind links");
    std::filesystem::create_directories(files_, problem);
    if (problem) fail(files_.string(), ": cannot be made: ", problem.message());
    for (const auto& [file, write] : new_) write(file);
}

std::string SceneWriter::newMesh(const std::shared_ptr<const void>& mesh, std::string_view extension,
                                 std::function<std::string()> bytes)
{
    if (!mesh) return {};
    const auto found = meshes_.find(mesh);
    if (found != meshes_.end()) return found->second;
    const auto write = [bytes = std::move(bytes)](const std::filesystem::path& file) { writeFile(file, bytes()); };
    return meshes_[mesh] = newFile(current_, extension, write);
}

std::string SceneWriter::meshFile(const TetPtr& mesh)
{
    return newMesh(mesh, ".msh", [mesh] { return geometry::gmshText(*mesh); });
}

std::string SceneWriter::meshFile(const TrianglePtr& mesh)
{
    return newMesh(mesh, ".vtk", [mesh] { return geometry::vtkText(*mesh); });
}

std::string SceneWriter::meshFile(const std::string& file)
{
    if (std::string name = nameOf(file); !name.empty() || file.empty()) return name;
    std::string& name = written_[file];
    if (!name.empty()) return name;
    try {
        return name = meshFile(std::make_shared<const geometry::TetMesh>(geometry::loadTetMesh(file)));
    } catch (const Error&) { // then it is a surface
        return name = meshFile(std::make_shared<const geometry::TriangleMesh>(geometry::loadTriangleMesh(file)));
    }
}

std::string SceneWriter::otherFile(const std::string& file)
{
    if (std::string name = nameOf(file); !name.empty() || file.empty()) return name;
    std::string& name = written_[file];
    if (!name.empty()) return name;
    const std::filesystem::path from(file);
    return name = newFile(from.stem().string(), from.extension().string(), [from](const std::filesystem::path& to) {
               std::error_code problem;
               std::filesystem::copy_file(from, to, std::filesystem::copy_options::overwrite_existing, problem);
               if (problem) fail(from.string(), ": cannot be copied to ", to.string(), ": ", problem.message());
           });
}

std::string SceneWriter::otherFile(const std::shared_ptr<const device::Motion>&)
{
    fail("a scene file cannot hold a motion in memory: write it into a file first");
}

void saveScene(const SceneDef& scene, const std::filesystem::path& file, const SaveOptions& options)
{
    checkFileName(file, file.string());
    if (file.extension() != ".json") fail(file.string(), ": a scene file has a name that ends in .json");
    std::error_code none;
    if (!std::filesystem::is_directory(std::filesystem::absolute(file).parent_path(), none))
        fail(file.string(), ": cannot be written: its folder is not there");
    std::string out;
    SceneWriter writer(file);
    print(out, writer.write(scene), 0, 0);
    writer.writeFiles(options.overwrite);
    writeFile(file, out + '\n');
}

} // namespace filasofia::scene
