#include "filasofia/core/hash.h"
#include "filasofia/core/log.h"
#include "filasofia/core/user_file.h"
#include "filasofia/core/word.h"
#include "filasofia/record/chunks.h"
#include "filasofia/record/json_limits.h"
#include "filasofia/record/json_reader.h"
#include "filasofia/record/mesh_bytes.h"
#include "filasofia/record/recording.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <set>
#include <utility>

namespace filasofia::record {
namespace {

using physics::StepRecord;

constexpr std::size_t kMaxListLength = 1 << 28; ///< nodes or elements of a mesh

/// A predicate for a set of names, to find unknown ones.
template <class... Names> auto oneOf(Names... names)
{
    return [=](std::string_view name) { return ((name == names) || ...); };
}

std::uint64_t hashOf(const Json& json, const char* name, const JsonReader& reader)
{
    std::string digits;
    reader.member(json, name, digits);
    std::uint64_t hash = 0;
    const char* end = digits.data() + digits.size();
    const auto [stop, problem] = std::from_chars(digits.data(), end, hash, 16);
    if (digits.size() != 16 || stop != end || problem != std::errc())
        Place{nullptr, name}.refuse("must be 16 hexadecimal digits", digits);
    return hash;
}

/// The program that wrote a recording, and this one.
std::string madeBy(const RecordingHeader& header)
{
    return text("Filasofia ", shortened(oneLine(header.filasofia)), ", revision ",
                header.revision.empty() ? "unknown" : shortened(oneLine(header.revision)),
                ", wrote it; this is revision ", sourceRevision());
}

/// Logs each field once.
MissingField tellingOnce(const std::string& file)
{
    return [file, told = std::make_shared<std::set<std::string>>()](const std::string& field) {
        if (told->insert(field).second)
            logWarning(file, ": another revision wrote it; it has no ", field, ", which gets its default");
    };
}

RecordingHeader headerOf(const Json& json, JsonReader& reader)
{
    RecordingHeader header;
    reader.member(json, "filasofia", header.filasofia);
    reader.member(json, "revision", header.revision);
    if (header.revision == sourceRevision()) reader.missing = {};
    reader.member(json, "simd", header.simd);
    reader.member(json, "period", header.period);
    reader.member(json, "contact", header.contact);
    reader.member(json, "seed", header.seed);
    reader.member(json, "session", header.session);
    reader.member(json, "trainee", header.trainee);
    reader.member(json, "date", header.date);
    const bool named = json.contains("engine");
    if (named) reader.member(json, "engine", header.engine);
    reader.refuseUnknown(
        json, named ? 10 : 9,
        oneOf("filasofia", "revision", "simd", "engine", "period", "contact", "seed", "session", "trainee", "date"));
    return header;
}

/// The file's name, checked before it is opened: opening a pipe would wait for its writer.
std::string checkedRegular(const std::filesystem::path& file)
{
    // A session of hours may be long; it is read chunk by chunk.
    checkRegularFile(file, file.string(), std::numeric_limits<std::uintmax_t>::max());
    return file.string();
}

/// The content of a file's chunks as one stream of lines, and of bytes after lines that announce them.
class Stream {
public:
    explicit Stream(const std::string& name) : chunks_(name) {}

    /// The next line without its line break; nullopt at the end of the file. Valid until the next call.
    std::optional<std::string_view> line()
    {
        drop();
        for (std::size_t searched = 0;;) {
            const std::size_t found = content_.find('\n', at_ + searched);
            if (found != std::string::npos) {
                const std::string_view line = std::string_view(content_).substr(at_, found - at_);
                at_ = found + 1;
                return line;
            }
            searched = content_.size() - at_;
            if (searched > kMaximumLine)
                throw FileDamage(text(name(), ": damaged at byte ", chunks_.byte(), ": a record does not end"));
            if (!chunks_.next(content_)) return std::nullopt;
        }
    }
    /// Appends `count` values; false if the file ends before. If the announced length is wrong, no more than the file's
    /// content is read.
    template <class T> bool read(std::vector<T>& out, std::size_t count)
    {
        for (std::size_t left = count; left > 0;) {
            drop();
            while (content_.size() - at_ < sizeof(T))
                if (!chunks_.next(content_)) return false;
            const std::size_t here = std::min(left, (content_.size() - at_) / sizeof(T));
            const std::size_t before = out.size();
            out.resize(before + here);
            std::memcpy(out.data() + before, content_.data() + at_, here * sizeof(T));
            at_ += here * sizeof(T);
            left -= here;
        }
        return true;
    }
    [[nodiscard]] const std::string& name() const { return chunks_.name(); }
    [[nodiscard]] std::uint64_t byte() const { return chunks_.byte(); }

private:
    /// Discards what was read.
    void drop()
    {
        if (at_ < kMaximumChunk && at_ < content_.size()) return; // rarely, because it moves all that follows
        content_.erase(0, at_);
        at_ = 0;
    }

    ChunkReader chunks_;
    std::string content_;
    std::size_t at_ = 0;
};

} // namespace

struct RecordingReader::Impl {
    Stream stream;
    RecordingHeader header = {};
    JsonReader reader = {};
    std::vector<SceneRecord> scene = {};
    std::uint64_t record = 0;      ///< number of the last record
    std::uint64_t steps = 0;       ///< number of steps read
    physics::StepReport last = {}; ///< the last one read; a step's missing fields are taken from it
    bool ended = false;
    std::string problem = {}; ///< why reading ended before the end

    explicit Impl(const std::string& name) : stream(name) { reader.missing = tellingOnce(name); }

    [[noreturn]] void cutOff() const
    {
        throw FileDamage(text(stream.name(), ": cut off at byte ", stream.byte(), ", before the end of the session"));
    }
    template <class Take> void nextRecord(Take&& take)
    {
        const std::optional<std::string_view> line = stream.line();
        if (!line) cutOff();
        ++record;
        try {
            const Json json = parsed(*line);
            if (!json.is_object()) fail("a record must be an object");
            take(json);
        } catch (const FileDamage&) {
            throw;
        } catch (const Error& wrong) {
            fail(stream.name(), ": record ", record, ": ", wrong.what(),
                 reader.missing && record > 1 ? text(" (", madeBy(header), ")") : std::string());
        }
    }
    void readHeader()
    {
        nextRecord([this](const Json& json) { header = headerOf(json, reader); });
    }

    template <class T> void readMesh(const Json& json)
    {
        std::size_t number = 0;
        reader.member(json, "mesh", number);
        if (number != reader.meshes.size())
            Place{nullptr, "mesh"}.refuse(text("must be ", reader.meshes.size(), ", the number of the next mesh"),
                                          json["mesh"]);
        T mesh;
        std::size_t members = 2;
        std::vector<std::size_t> counts;
        forEachList(mesh, [&](const char* name, const auto&) {
            counts.push_back(0);
            if (kLabels == name && !json.contains(name)) return;
            reader.member(json, name, counts.back());
            if (counts.back() > kMaxListLength)
                Place{nullptr, name}.refuse(text("must be <= ", kMaxListLength), json[name]);
            ++members;
        });
        const std::uint64_t digest = hashOf(json, "digest", reader);
        reader.refuseUnknown(json, members, [&](std::string_view name) {
            bool known = oneOf("mesh", "digest")(name);
            forEachList(mesh, [&](std::string_view each, const auto&) { known = known || each == name; });
            return known;
        });
        std::size_t list = 0;
        bool whole = true;
        forEachList(mesh, [&](const char*, auto& out) { whole = whole && stream.read(out, counts[list++]); });
        if (!whole) cutOff();
        if (const std::uint64_t made = digestOf(mesh); made != digest)
            fail("mesh ", number, ": its digest must be ", hexadecimal(digest), ", got ", hexadecimal(made));
        reader.meshes.push_back(std::make_shared<const T>(std::move(mesh)));
    }

    void readScene(const Json& json)
    {
        SceneRecord& out = scene.emplace_back();
        out.missing = reader.missing;
        if (!json["scene"].is_object()) Place{nullptr, "scene"}.refuse("must be an object", json["scene"]);
        out.words = json["scene"].dump(-1, ' ', false, Json::error_handler_t::replace);
        physics::TriangleMeshSource surface;
        const Json numbers = json.value("surfaces", Json());
        if (!numbers.is_array()) Place{nullptr, "surfaces"}.refuse("must be a list", numbers);
        for (const Json& number : numbers) {
            reader.read(number, surface, Place{nullptr, "surfaces"});
            const auto* held = std::get_if<TriangleMesh>(&surface);
            if (!held) Place{nullptr, "surfaces"}.refuse("must be numbers of meshes", number);
            out.surfaces.push_back(*held);
        }
        reader.refuseUnknown(json, 2, oneOf("scene", "surfaces"));
    }

    StepRecord stepOf(const Json& json)
    {
        StepRecord step;
        std::size_t members = 0;
        const auto given = [&](const char* name, auto& out) {
            if (!json.contains(name)) return false;
            ++members;
            reader.member(json, name, out);
            return true;
        };
        physics::StepReport& report = step.report;
        if (!given("step", report.step)) report.step = last.step + 1;
        if (steps == 0) reader.member(json, "dt", report.dt);
        if (!given("dt", report.dt)) report.dt = last.dt;
        given("flags", report.flags);
        if (std::vector<int> iterations; given("iterations", iterations)) {
            for (const int each : iterations) {
                if (each < 0) fail("iterations must be >= 0, got ", each);
                report.solves.push_back({.body = {}, .iterations = each});
            }
        } else {
            report.solves = last.solves;
        }
        if (json.contains("hash")) {
            ++members;
            step.hash = hashOf(json, "hash", reader);
        }
        given("commands", step.commands);
        reader.refuseUnknown(json, members, oneOf("step", "dt", "flags", "iterations", "hash", "commands"));
        last.step = report.step;
        last.dt = report.dt;
        last.solves = report.solves;
        ++steps;
        return step;
    }

    void readEnd(const Json& json)
    {
        std::uint64_t count = 0;
        reader.member(json, "end", count);
        reader.refuseUnknown(json, 1, oneOf("end"));
        if (count != steps) fail("the end of the session announces ", count, " steps, but the file holds ", steps);
        ended = true;
        if (stream.line()) fail("the file must end after the end of the session");
    }

    std::optional<StepRecord> next()
    {
        std::optional<StepRecord> step;
        while (!step && !ended)
            nextRecord([&](const Json& json) {
                if (json.contains("mesh"))
                    json.contains("tetrahedra") ? readMesh<geometry::TetMesh>(json)
                                                : readMesh<geometry::TriangleMesh>(json);
                else if (json.contains("scene"))
                    readScene(json);
                else if (json.contains("end"))
                    readEnd(json);
                else
                    step = stepOf(json);
            });
        return step;
    }
};

RecordingReader::RecordingReader(const std::filesystem::path& file)
    : impl_(std::make_unique<Impl>(checkedRegular(file)))
{
    impl_->readHeader();
}

RecordingReader::~RecordingReader() = default;

const RecordingHeader& RecordingReader::header() const { return impl_->header; }

std::optional<StepRecord> RecordingReader::next()
{
    if (!impl_->problem.empty()) throw Error(impl_->problem);
    try {
        return impl_->next();
    } catch (const Error& damage) {
        const std::uint64_t steps = impl_->steps;
        impl_->problem = text(damage.what(), steps > 0 ? text("; it is complete up to step ", impl_->last.step)
                                                       : std::string("; it has no complete step"));
        throw Error(impl_->problem);
    }
}

std::vector<SceneRecord> RecordingReader::takeScene() { return std::exchange(impl_->scene, {}); }

Recording readRecording(const std::filesystem::path& file)
{
    Recording recording = readUpToDamage(file);
    if (!recording.damage.empty()) throw Error(recording.damage);
    return recording;
}

Recording readUpToDamage(const std::filesystem::path& file)
{
    RecordingReader reader(file);
    Recording recording{.header = reader.header()};
    try {
        while (auto step = reader.next()) recording.steps.push_back(std::move(*step));
    } catch (const Error& damage) {
        recording.damage = damage.what();
    }
    return recording;
}

} // namespace filasofia::record
