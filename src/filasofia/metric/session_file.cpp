#include "filasofia/metric/session_file.h"

#include "filasofia/core/error.h"
#include "filasofia/core/user_file.h"
#include "filasofia/core/word.h"
#include "filasofia/metric/sample_line.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <fstream>
#include <span>

namespace filasofia::metric {
namespace {

using Json = nlohmann::json;

constexpr const char* kFormat = "filasofia session";
// The file is not trusted: nothing in it makes the reader use more memory than this.
constexpr std::size_t kMaxLine = 1 << 20;
constexpr std::size_t kMaxTracks = 64;
constexpr std::size_t kMaxSamples = 50'000'000;
constexpr std::size_t kMaxEvents = 1'000'000;

void appendNumber(std::string& out, double value)
{
    if (std::isfinite(value)) {
        detail::append(out, value);
    } else {
        out += "null"; // JSON has no NaN
    }
}

void appendSample(std::string& out, const Sample& sample, bool force)
{
    const Vec3 &p = sample.pose.position, &f = sample.force, &c = sample.point;
    const Quat& q = sample.pose.orientation;
    out += '[';
    for (const double value : {p.x, p.y, p.z, q.w, q.x, q.y, q.z}) {
        appendNumber(out, value);
        out += ',';
    }
    if (force) {
        for (const double value : {f.x, f.y, f.z}) {
            appendNumber(out, value);
            out += ',';
        }
        detail::append(out, sample.contacts);
        out += ',';
        if (sample.contacts > 0) // otherwise there is no point
            for (const double value : {c.x, c.y, c.z}) {
                appendNumber(out, value);
                out += ',';
            }
    }
    out.back() = ']';
}

/// Names are typed by users: bytes that are not UTF-8 become the replacement character.
std::string dumped(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n"; }

Json vector(Vec3 v) { return {v.x, v.y, v.z}; }

/// Reads a session; an Error names file and line.
class Reader {
public:
    Reader(std::istream& stream, const std::string& name) : name_(name), stream_(stream) {}

    Session read()
    {
        if (!nextLine()) fail(name_, ": must be a session, got an empty file");
        readHead(parsed());
        row_.resize(session_.tracks.size());
        session_.complete = false;
        while (nextLine()) {
            // If a line is incomplete, the session was interrupted there.
            if (broken_) break;
            if (session_.complete) wrong("there must be no line after the end");
            if (!scanSamples()) readLine(parsed());
        }
        if (!stream_.eof()) fail(name_, ": cannot be read completely");
        return std::move(session_);
    }

private:
    [[noreturn]] void wrong(std::string_view what) const { fail(name_, ", line ", line_, ": ", what); }

    bool nextLine()
    {
        ++line_;
        stream_.getline(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
        const auto size = static_cast<std::size_t>(stream_.gcount());
        if (stream_.fail() && size + 1 >= buffer_.size())
            wrong("must be shorter than 1 MiB, as every line of a session");
        broken_ = stream_.eof(); // otherwise the size includes the line break
        text_ = {buffer_.data(), broken_ || size == 0 ? size : size - 1};
        return !broken_ || size > 0;
    }

    Json parsed() const
    {
        Json json = Json::parse(text_, nullptr, false);
        if (json.is_discarded() || !json.is_object()) wrong("must be a JSON object");
        return json;
    }

    static const Json* find(const Json& json, const char* key)
    {
        const auto found = json.find(key);
        return found == json.end() || found->is_null() ? nullptr : &*found;
    }

    double number(const Json& json, const char* what) const
    {
        if (!json.is_number()) wrong(text("'", what, "' must be a number"));
        return json.get<double>();
    }
    std::string word(const Json& json, const char* what) const
    {
        if (!json.is_string()) wrong(text("'", what, "' must be a text"));
        return json.get<std::string>();
    }
    void take(const Json& json, const char* key, std::string& target) const
    {
        if (const Json* found = find(json, key)) target = word(*found, key);
    }
    void take(const Json& json, const char* key, std::optional<double>& target) const
    {
        const Json* found = find(json, key);
        if (!found) return;
        target = number(*found, key);
        if (!(*target > 0.0)) wrong(text("'", key, "' must be > 0, got ", *target));
    }
    void take(const Json& json, const char* key, Vec3& target) const
    {
        const Json* found = find(json, key);
        if (!found) return;
        if (!found->is_array() || found->size() != 3) wrong(text("'", key, "' must be three numbers"));
        target = {number((*found)[0], key), number((*found)[1], key), number((*found)[2], key)};
        if (!(length(target) > 0.0)) wrong(text("'", key, "' must have a length > 0"));
    }
    template <class Take> void forEach(const Json& json, const char* key, Take&& take) const
    {
        const Json* found = find(json, key);
        if (!found) return;
        if (!found->is_array()) wrong(text("'", key, "' must be a list"));
        for (const Json& each : *found) take(each);
    }

    void readHead(const Json& json)
    {
        const Json* format = find(json, "format");
        if (!format || *format != kFormat) wrong("this is not a Filasofia session");
        const Json* version = find(json, "version");
        if (!version || *version != kSessionVersion)
            wrong(text("the session has version ", version ? shortened(version->dump()) : "unknown",
                       ", but this program reads version ", kSessionVersion));
        take(json, "trainee", session_.trainee);
        take(json, "case", session_.task);
        take(json, "date", session_.date);
        take(json, "software", session_.software);
        if (const Json* seed = find(json, "seed")) {
            if (!seed->is_number_unsigned()) wrong("'seed' must be a whole number >= 0");
            session_.seed = seed->get<std::uint64_t>();
        }
        take(json, "idealPath", session_.idealPath);
        take(json, "forceLimit", session_.forceLimit);
        take(json, "fieldOfView", session_.fieldOfView);
        take(json, "up", session_.up);
        forEach(json, "targets", [&](const Json& each) { session_.targets.push_back(word(each, "targets")); });
        forEach(json, "steps", [&](const Json& each) { session_.steps.push_back(word(each, "steps")); });
        forEach(json, "watched", [&](const Json& each) { session_.watched.push_back(kindOf(word(each, "watched"))); });
        forEach(json, "tracks", [&](const Json& each) { readTrack(each); });
        if (session_.tracks.size() > kMaxTracks) wrong(text("the number of tracks must be <= ", kMaxTracks));
    }

    EventKind kindOf(const std::string& word) const
    {
        const auto kind = eventKind(word);
        if (!kind) wrong(text("the kind of an event must be one of Filasofia's, got '", shortened(word), "'"));
        return *kind;
    }

    void readTrack(const Json& json)
    {
        if (!json.is_object()) wrong("a track must be an object");
        Track track;
        take(json, "name", track.name);
        std::string role = std::string(name(track.role));
        take(json, "role", role);
        for (const Role each : {Role::Tool, Role::Scope, Role::Other})
            if (role == name(each)) track.role = each;
        if (role != name(track.role)) wrong(text("'role' must be tool, scope or other, got '", shortened(role), "'"));
        if (const Json* force = find(json, "force")) {
            if (!force->is_boolean()) wrong("'force' must be true or false");
            track.force = force->get<bool>();
        }
        take(json, "axis", track.axis);
        take(json, "up", track.up);
        session_.tracks.push_back(std::move(track));
    }

    void readLine(const Json& json)
    {
        if (const Json* lost = find(json, "end")) {
            if (!lost->is_number_unsigned()) wrong("'end' must be the number of lost samples");
            session_.lost = lost->get<std::uint64_t>();
            session_.complete = true;
        } else if (const Json* back = find(json, "back")) {
            takeBack(session_, number(*back, "back"));
            samples_ = 0;
            for (const Track& track : session_.tracks) samples_ += track.samples.size();
        } else if (const Json* kind = find(json, "event")) {
            readEvent(json, word(*kind, "event"));
        } else {
            readSamples(json);
        }
    }

    double time(const Json& json) const
    {
        const Json* found = find(json, "t");
        if (!found) wrong("field 't', the time, is missing");
        return number(*found, "t");
    }

    void readEvent(const Json& json, const std::string& kind)
    {
        if (session_.events.size() >= kMaxEvents) wrong(text("the number of events must be <= ", kMaxEvents));
        Event event{.time = time(json), .kind = kindOf(kind)};
        take(json, "what", event.what);
        if (const Json* amount = find(json, "amount")) event.amount = number(*amount, "amount");
        // Events come from another thread than samples, and may arrive a little late.
        const auto later = std::upper_bound(session_.events.begin(), session_.events.end(), event.time,
                                            [](double when, const Event& each) { return when < each.time; });
        session_.events.insert(later, std::move(event));
    }

    void readSamples(const Json& json)
    {
        const double when = time(json);
        const Json* list = find(json, "s");
        if (!list || !list->is_array() || list->size() != session_.tracks.size())
            wrong(text("'s' must be a list of samples of ", session_.tracks.size(), " tracks"));
        count(list->size());
        for (std::size_t i = 0; i < list->size(); ++i)
            session_.tracks[i].samples.push_back(sampleFrom(when, (*list)[i]));
    }

    /// Nearly every line contains samples.
    bool scanSamples()
    {
        if (!scanSampleLine(text_, row_)) return false;
        count(row_.size());
        for (std::size_t i = 0; i < row_.size(); ++i) session_.tracks[i].samples.push_back(row_[i]);
        return true;
    }

    void count(std::size_t samples)
    {
        if ((samples_ += samples) > kMaxSamples) wrong(text("the number of samples must be <= ", kMaxSamples));
    }

    Sample sampleFrom(double when, const Json& json) const
    {
        double numbers[kNumbers];
        if (!json.is_array() || json.size() > kNumbers) wrong("a sample must have 7, 11 or 14 numbers");
        for (std::size_t i = 0; i < json.size(); ++i) numbers[i] = json[i].is_null() ? kNan : number(json[i], "s");
        const auto sample = sampleOf(when, std::span(numbers, json.size()));
        if (!sample) wrong("a sample must have 7, 11 or 14 numbers, of which the eleventh is the number of contacts");
        return *sample;
    }

    const std::string& name_;
    std::istream& stream_;
    std::vector<char> buffer_ = std::vector<char>(kMaxLine);
    std::string_view text_; ///< the current line, in the buffer
    std::size_t line_ = 0, samples_ = 0;
    std::vector<Sample> row_; ///< one per track
    bool broken_ = false;     ///< the line has no line break
    Session session_;
};

} // namespace

std::string headLine(const Session& session)
{
    Json json = {{"format", kFormat},      {"version", kSessionVersion}, {"trainee", session.trainee},
                 {"case", session.task},   {"date", session.date},       {"software", session.software},
                 {"seed", session.seed},   {"up", vector(session.up)},   {"targets", session.targets},
                 {"steps", session.steps}, {"watched", Json::array()},   {"tracks", Json::array()}};
    if (session.idealPath) json["idealPath"] = *session.idealPath;
    if (session.forceLimit) json["forceLimit"] = *session.forceLimit;
    if (session.fieldOfView) json["fieldOfView"] = *session.fieldOfView;
    for (const EventKind kind : session.watched) json["watched"].push_back(std::string(name(kind)));
    for (const Track& track : session.tracks)
        json["tracks"].push_back({{"name", track.name},
                                  {"role", std::string(name(track.role))},
                                  {"force", track.force},
                                  {"axis", vector(track.axis)},
                                  {"up", vector(track.up)}});
    return dumped(json);
}

void appendSampleLine(std::string& out, const Session& session, std::span<const Sample> samples)
{
    out += "{\"t\":";
    appendNumber(out, samples.empty() ? 0.0 : samples.front().time);
    out += ",\"s\":[";
    for (std::size_t i = 0; i < samples.size(); ++i) {
        if (i > 0) out += ',';
        appendSample(out, samples[i], session.tracks[i].force);
    }
    out += "]}\n";
}

std::string eventLine(const Event& event)
{
    Json json = {{"t", event.time}, {"event", std::string(name(event.kind))}, {"what", event.what}};
    if (event.amount) json["amount"] = *event.amount;
    return dumped(json);
}

std::string backLine(double time)
{
    std::string line = "{\"back\":";
    appendNumber(line, time);
    return line + "}\n";
}

std::string endLine(std::uint64_t lost) { return text("{\"end\":", lost, "}\n"); }

void writeSession(const std::filesystem::path& file, const Session& session)
{
    const std::size_t count = session.tracks.empty() ? 0 : session.tracks.front().samples.size();
    for (const Track& track : session.tracks)
        if (track.samples.size() != count) fail(file.string(), ": all tracks must have the same number of samples");
    std::ofstream out(file, std::ios::binary | std::ios::trunc);
    out << headLine(session);
    std::size_t next = 0; // event
    std::vector<Sample> row(session.tracks.size());
    std::string line;
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t k = 0; k < row.size(); ++k) row[k] = session.tracks[k].samples[i];
        for (; next < session.events.size() && session.events[next].time <= row.front().time; ++next)
            out << eventLine(session.events[next]);
        line.clear();
        appendSampleLine(line, session, row);
        out << line;
    }
    for (; next < session.events.size(); ++next) out << eventLine(session.events[next]);
    if (session.complete) out << endLine(session.lost);
    if (!out.flush()) fail(file.string(), ": cannot be written");
}

Session readSession(const std::filesystem::path& file)
{
    const std::string name = file.string();
    checkRegularFile(file, name);
    std::ifstream stream(file, std::ios::binary);
    if (!stream) fail(name, ": cannot be read");
    return Reader(stream, name).read();
}

Session readSession(std::istream& stream, const std::string& name) { return Reader(stream, name).read(); }

} // namespace filasofia::metric
