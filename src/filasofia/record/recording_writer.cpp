#include "filasofia/record/recording.h"

#include "filasofia/core/hash.h"
#include "filasofia/core/log.h"
#include "filasofia/core/output_file.h"
#include "filasofia/record/chunks.h"
#include "filasofia/record/json_limits.h"
#include "filasofia/record/json_writer.h"
#include "filasofia/record/mesh_bytes.h"
#include "filasofia/record/replayable.h"

#include <algorithm>
#include <utility>

namespace filasofia::record {
namespace {

/// A name may hold any bytes; in the file, bytes that are not UTF-8 become U+FFFD.
std::string lineOf(const Json& json)
{
    std::string line = json.dump(-1, ' ', false, Json::error_handler_t::replace);
    if (line.size() > kMaximumLine) // no reader would accept it
        fail("a record must be <= ", kMaximumLine, " bytes, got ", line.size());
    return line + '\n';
}

} // namespace

struct RecordingWriter::Impl {
    OutputFile file;
    JsonWriter json = {};
    std::string content = {}; ///< content of the next chunk
    std::uint32_t chunks = 0; ///< number of chunks written
    std::size_t meshes = 0;   ///< number of meshes written
    std::uint64_t steps = 0;  ///< number of steps written
    bool open = true;         ///< the end has not been written
    bool warned = false;
    physics::StepReport last = {}; ///< the last step written; the next one contains only what differs

    void append(std::string_view bytes)
    {
        while (!bytes.empty()) {
            const std::string_view part = bytes.substr(0, kMaximumChunk - content.size());
            content += part;
            bytes.remove_prefix(part.size());
            if (content.size() == kMaximumChunk) writeChunk();
        }
    }
    void writeChunk()
    {
        if (content.empty()) return;
        file.write(chunkOf(chunks++, content));
        content.clear();
    }

    template <class T> void appendMesh(const T& mesh)
    {
        Json line = {{"mesh", meshes++}};
        forEachList(mesh, [&](const char* name, const auto& list) {
            if (kLabels != name || !list.empty()) line[name] = list.size();
        });
        line["digest"] = hexadecimal(digestOf(mesh));
        append(lineOf(line));
        forEachList(mesh, [&](const char*, const auto& list) { append(bytesOf(list)); });
    }
    void appendNewMeshes()
    {
        for (const Mesh& mesh : json.takeNewMeshes()) std::visit([this](const auto& held) { appendMesh(*held); }, mesh);
    }

    /// Fields equal to those of the previous step are left out, because most of 600,000 steps differ only in their
    /// hash.
    Json lineFor(const physics::StepRecord& step)
    {
        const physics::StepReport& report = step.report;
        const auto iterations = [](const physics::BodySolve& solve) { return solve.iterations; };
        Json line = Json::object();
        if (report.step != last.step + 1) line["step"] = report.step;
        if (steps == 0 || std::bit_cast<std::uint64_t>(report.dt) != std::bit_cast<std::uint64_t>(last.dt))
            line["dt"] = json.write(report.dt);
        if (report.flags != 0) line["flags"] = report.flags;
        if (!std::ranges::equal(report.solves, last.solves, {}, iterations, iterations)) {
            line["iterations"] = Json::array();
            for (const physics::BodySolve& solve : report.solves) line["iterations"].push_back(solve.iterations);
        }
        if (step.hash != 0) line["hash"] = hexadecimal(step.hash);
        if (!step.commands.empty()) line["commands"] = json.write(step.commands);
        return line;
    }

    void warnOnce(const physics::StepRecord& step)
    {
        const auto why = whyNotReplayable(step);
        if (why.empty() || std::exchange(warned, true)) return;
        logWarning(file.name(), ": a replay will stop at step ", step.report.step, ": ", why);
    }
};

RecordingWriter::RecordingWriter(const std::filesystem::path& file, const RecordingHeader& header)
    : impl_(new Impl{OutputFile(file)})
{
    impl_->file.write(openingLine());
    Json line = {{"filasofia", FILASOFIA_VERSION},
                 {"revision", FILASOFIA_REVISION},
                 {"simd", header.simd},
                 {"period", impl_->json.write(header.period)},
                 {"contact", impl_->json.write(header.contact)},
                 {"seed", header.seed},
                 {"session", header.session},
                 {"trainee", header.trainee},
                 {"date", header.date}};
    if (header.engine != RecordingHeader{}.engine) line["engine"] = header.engine; // older readers refuse the field
    impl_->append(lineOf(line));
}

RecordingWriter::~RecordingWriter()
{
    try {
        if (!impl_->file.failed()) close();
    } catch (const Error& problem) {
        logError(problem.what());
    }
}

void RecordingWriter::write(const physics::StepRecord& step)
{
    const Json line = impl_->lineFor(step);
    impl_->appendNewMeshes();
    impl_->append(lineOf(line));
    ++impl_->steps;
    impl_->last.step = step.report.step;
    impl_->last.dt = step.report.dt;
    impl_->last.solves = step.report.solves;
    impl_->warnOnce(step);
}

void RecordingWriter::write(const SceneRecord& scene)
{
    Json surfaces = Json::array();
    for (const auto& surface : scene.surfaces) surfaces.push_back(impl_->json.write(surface));
    const Json line = {{"scene", Json::parse(scene.words)}, {"surfaces", surfaces}};
    impl_->appendNewMeshes();
    impl_->append(lineOf(line));
}

void RecordingWriter::flush()
{
    impl_->writeChunk();
    impl_->file.flush();
}

void RecordingWriter::close()
{
    if (!std::exchange(impl_->open, false)) return;
    impl_->append(lineOf({{"end", impl_->steps}}));
    impl_->writeChunk();
    impl_->file.close();
}

std::string_view sourceRevision() { return FILASOFIA_REVISION; }

} // namespace filasofia::record
