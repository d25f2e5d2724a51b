#include "filasofia/record/json_reader.h"
#include "filasofia/record/recording.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <utility>

namespace filasofia::record {
namespace {

using physics::StepRecord;

/// A set of names, for finding those that do not belong.
template <class... Names> auto oneOf(Names... names)
{
    return [=](std::string_view name) { return ((name == names) || ...); };
}

std::uint64_t hashOf(const std::string& digits)
{
    std::uint64_t hash = 0;
    const char* end = digits.data() + digits.size();
    const auto [stop, problem] = std::from_chars(digits.data(), end, hash, 16);
    if (digits.size() != 16 || stop != end || problem != std::errc())
        Place{nullptr, "hash"}.refuse("must be 16 hexadecimal digits", digits);
    return hash;
}

RecordingHeader headerOf(const Json& json, const JsonReader& reader)
{
    std::string format;
    if (json.contains("format")) reader.member(json, "format", format);
    if (format != kFormat) fail("this is no Filasofia recording");
    int version = 0;
    reader.member(json, "version", version);
    if (version != kVersion) fail("the recording is of version ", version, ", this Filasofia reads version ", kVersion);
    RecordingHeader header;
    reader.member(json, "filasofia", header.filasofia);
    reader.member(json, "period", header.period);
    reader.member(json, "revision", header.revision);
    reader.member(json, "simd", header.simd);
    reader.member(json, "contact", header.contact);
    reader.noOthers(json, 7, oneOf("format", "version", "filasofia", "revision", "simd", "period", "contact"));
    return header;
}

Mesh meshOf(const Json& json, const JsonReader& reader)
{
    std::size_t number = 0;
    reader.member(json, "mesh", number);
    if (number != reader.meshes.size())
        Place{nullptr, "mesh"}.refuse(text("must be ", reader.meshes.size(), ", the next number"), json["mesh"]);
    if (json.contains("triangles")) {
        geometry::TriangleMesh mesh;
        reader.member(json, "vertices", mesh.vertices);
        reader.member(json, "triangles", mesh.triangles);
        reader.member(json, "uv", mesh.uv);
        reader.noOthers(json, 4, oneOf("mesh", "vertices", "triangles", "uv"));
        return std::make_shared<const geometry::TriangleMesh>(std::move(mesh));
    }
    geometry::TetMesh mesh;
    reader.member(json, "nodes", mesh.nodes);
    reader.member(json, "tetrahedra", mesh.tetrahedra);
    reader.noOthers(json, 3, oneOf("mesh", "nodes", "tetrahedra"));
    return std::make_shared<const geometry::TetMesh>(std::move(mesh));
}

StepRecord stepOf(const Json& json, const JsonReader& reader)
{
    StepRecord record;
    std::string hash;
    std::vector<int> iterations;
    reader.member(json, "step", record.report.step);
    reader.member(json, "dt", record.report.dt);
    reader.member(json, "flags", record.report.flags);
    reader.member(json, "hash", hash);
    reader.member(json, "iterations", iterations);
    reader.member(json, "commands", record.commands);
    reader.noOthers(json, 6, oneOf("step", "dt", "flags", "hash", "iterations", "commands"));
    record.hash = hashOf(hash);
    for (const int each : iterations) {
        if (each < 0) fail("iterations must be >= 0, got ", each);
        record.report.solves.push_back({.body = {}, .iterations = each});
    }
    return record;
}

/// The file, looked at before it is opened: opening a pipe would wait for its writer.
const std::filesystem::path& checkedRegular(const std::filesystem::path& file)
{
    std::error_code problem;
    const std::filesystem::file_status status = std::filesystem::status(file, problem);
    if (!std::filesystem::exists(status)) fail(file.string(), ": cannot be read");
    if (std::filesystem::is_directory(status)) fail(file.string(), ": is a folder");
    if (!std::filesystem::is_regular_file(status)) fail(file.string(), ": is no regular file");
    return file;
}

} // namespace

struct RecordingReader::Impl {
    std::string name;
    std::ifstream in;
    RecordingHeader header = {};
    JsonReader reader = {};
    std::uint64_t line = 0;      ///< read last
    std::uint64_t lastWhole = 0; ///< step

    explicit Impl(const std::filesystem::path& file) : name(file.string()), in(file, std::ios::binary) {}

    /// Hands the next line to `take`; false at the end of the file. Whatever is wrong names file and line.
    template <class Take> bool nextLine(Take&& take)
    {
        std::string words;
        if (!std::getline(in, words)) {
            if (in.bad()) fail(name, ": cannot be read");
            return false;
        }
        ++line;
        // Without its line break the last line was being written when the program, or the disk, came to an end.
        const bool cutOff = in.eof();
        try {
            const Json json = Json::parse(words);
            if (!json.is_object()) fail("a line must be an object");
            take(json);
        } catch (const Json::exception& problem) {
            if (cutOff && line > 1) fail(name, ":", line, ": the file is cut off after step ", lastWhole);
            fail(name, ":", line, ": this is no line of a recording: ", problem.what());
        } catch (const Error& problem) {
            fail(name, ":", line, ": ", problem.what());
        }
        return true;
    }
};

RecordingReader::RecordingReader(const std::filesystem::path& file)
    : impl_(std::make_unique<Impl>(checkedRegular(file)))
{
    if (!impl_->in) fail(impl_->name, ": cannot be read");
    if (!impl_->nextLine([this](const Json& json) { impl_->header = headerOf(json, impl_->reader); }))
        fail(impl_->name, ": is empty, no recording");
}

RecordingReader::~RecordingReader() = default;

const RecordingHeader& RecordingReader::header() const { return impl_->header; }

std::optional<StepRecord> RecordingReader::next()
{
    std::optional<StepRecord> record;
    const auto take = [&](const Json& json) {
        if (json.contains("mesh"))
            impl_->reader.meshes.push_back(meshOf(json, impl_->reader));
        else
            record = stepOf(json, impl_->reader);
    };
    while (!record && impl_->nextLine(take)) {
    }
    if (record) impl_->lastWhole = record->report.step;
    return record;
}

Recording readRecording(const std::filesystem::path& file)
{
    RecordingReader reader(file);
    Recording recording{.header = reader.header()};
    while (auto step = reader.next()) recording.steps.push_back(std::move(*step));
    return recording;
}

} // namespace filasofia::record
