#include "filasofia/record/recording.h"

#include "filasofia/core/hash.h"
#include "filasofia/core/log.h"
#include "filasofia/record/json_writer.h"
#include "filasofia/record/output_file.h"
#include "filasofia/record/repeatable.h"

#include <utility>

namespace filasofia::record {
namespace {

/// A name may hold any bytes; in the file those that are no UTF-8 become U+FFFD.
std::string lineOf(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace) + '\n'; }

} // namespace

struct RecordingWriter::Impl {
    OutputFile file;
    JsonWriter json = {};
    std::size_t meshes = 0; ///< written
    bool warned = false;

    Json meshLine(const geometry::TetMesh& mesh)
    {
        return {{"mesh", meshes++}, {"nodes", json.write(mesh.nodes)}, {"tetrahedra", json.write(mesh.tetrahedra)}};
    }
    Json meshLine(const geometry::TriangleMesh& mesh)
    {
        return {{"mesh", meshes++},
                {"vertices", json.write(mesh.vertices)},
                {"triangles", json.write(mesh.triangles)},
                {"uv", json.write(mesh.uv)}};
    }

    void warnOnce(const physics::StepRecord& step)
    {
        const auto why = whyNotRepeatable(step);
        if (why.empty() || std::exchange(warned, true)) return;
        logWarning(file.name(), ": no replay can go beyond step ", step.report.step, ": ", why);
    }
};

RecordingWriter::RecordingWriter(const std::filesystem::path& file, const RecordingHeader& header)
    : impl_(new Impl{OutputFile(file)})
{
    impl_->file.write(lineOf({{"format", kFormat},
                              {"version", kVersion},
                              {"filasofia", FILASOFIA_VERSION},
                              {"revision", FILASOFIA_REVISION},
                              {"simd", header.simd},
                              {"period", impl_->json.write(header.period)},
                              {"contact", impl_->json.write(header.contact)}}));
}

RecordingWriter::~RecordingWriter() = default;

void RecordingWriter::write(const physics::StepRecord& step)
{
    Json iterations = Json::array();
    for (const physics::BodySolve& solve : step.report.solves) iterations.push_back(solve.iterations);
    const Json line = {{"step", step.report.step},   {"dt", impl_->json.write(step.report.dt)},
                       {"flags", step.report.flags}, {"hash", hexadecimal(step.hash)},
                       {"iterations", iterations},   {"commands", impl_->json.write(step.commands)}};
    for (const Mesh& mesh : impl_->json.takeNewMeshes())
        impl_->file.write(lineOf(std::visit([&](const auto& held) { return impl_->meshLine(*held); }, mesh)));
    impl_->file.write(lineOf(line));
    impl_->warnOnce(step);
}

void RecordingWriter::flush() { impl_->file.flush(); }
void RecordingWriter::close() { impl_->file.close(); }

std::string_view sourceRevision() { return FILASOFIA_REVISION; }

} // namespace filasofia::record
