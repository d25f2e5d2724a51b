#include "filasofia/record/chunks.h"

#include "filasofia/core/assert.h"
#include "filasofia/core/text.h"
#include "filasofia/core/word.h"
#include "filasofia/record/json_shapes.h"

#include <zlib.h>

#include <algorithm>

namespace filasofia::record {
namespace {

constexpr std::size_t kMaxOpeningLine = 4096; ///< bytes read from a file of another kind to say what it is
/// The deflated size of kMaximumChunk incompressible bytes, with a margin.
constexpr std::size_t kMaximumStored = kMaximumChunk + kMaximumChunk / 100 + 64;

/// Four bytes, lowest first, on every machine.
void put(std::string& out, std::uint32_t number)
{
    for (int shift = 0; shift < 32; shift += 8) out += static_cast<char>(number >> shift & 0xff);
}
std::uint32_t get(std::string_view bytes, std::size_t at)
{
    std::uint32_t number = 0;
    for (std::size_t i = 0; i < 4; ++i)
        number |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[at + i])) << (8 * i);
    return number;
}

std::uint32_t crcOf(std::string_view fields, std::string_view stored)
{
    const auto add = [](uLong crc, std::string_view bytes) {
        return crc32(crc, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size()));
    };
    return static_cast<std::uint32_t>(add(add(crc32(0, nullptr, 0), fields), stored));
}

std::string deflated(std::string_view content)
{
    z_stream stream = {};
    // Most of a session consists of digits that never repeat: Z_FILTERED ignores short accidental repetitions, which
    // makes a moving tool's poses a tenth smaller.
    int answer = deflateInit2(&stream, 6, Z_DEFLATED, MAX_WBITS, 8, Z_FILTERED);
    if (answer != Z_OK) fail("recording: zlib cannot compress: ", zError(answer));
    std::string stored(deflateBound(&stream, static_cast<uLong>(content.size())), '\0');
    std::string input(content); // zlib does not change it, but takes no const
    stream.next_in = reinterpret_cast<Bytef*>(input.data());
    stream.avail_in = static_cast<uInt>(input.size());
    stream.next_out = reinterpret_cast<Bytef*>(stored.data());
    stream.avail_out = static_cast<uInt>(stored.size());
    answer = deflate(&stream, Z_FINISH);
    stored.resize(stream.total_out);
    deflateEnd(&stream);
    if (answer != Z_STREAM_END) fail("recording: zlib cannot compress: ", zError(answer));
    return stored;
}

/// Files before version 4 consisted of lines of JSON, with the version in the first line.
std::string olderVersion(const std::string& line)
{
    const Json json = Json::parse(line, nullptr, false);
    if (!json.is_object() || json.value("format", Json()) != Json("filasofia recording")) return {};
    const auto said = [&](const char* field) {
        const Json value = json.value(field, Json());
        return value.is_string() ? shortened(oneLine(value.get<std::string>())) : std::string("unknown");
    };
    const Json version = json.value("version", Json());
    if (!version.is_number_integer()) return {};
    return text("the recording has version ", version.dump(), ", but this Filasofia reads version ", kVersion,
                "; Filasofia ", said("filasofia"), ", revision ", said("revision"), ", wrote it and can replay it");
}

} // namespace

std::string openingLine() { return text(kOpening, kVersion, '\n'); }

std::string chunkOf(std::uint32_t number, std::string_view content)
{
    FILASOFIA_ASSERT(content.size() <= kMaximumChunk);
    const std::string stored = deflated(content);
    std::string fields;
    put(fields, number);
    put(fields, static_cast<std::uint32_t>(content.size()));
    put(fields, static_cast<std::uint32_t>(stored.size()));
    std::string chunk(kChunkMark);
    chunk += fields;
    put(chunk, crcOf(fields, stored));
    return chunk + stored;
}

ChunkReader::ChunkReader(const std::string& name) : name_(name), in_(name, std::ios::binary)
{
    if (!in_) fail(name_, ": cannot be read");
    std::string line;
    for (char c = 0; line.size() < kMaxOpeningLine && in_.get(c) && c != '\n';) line += c;
    if (in_.bad()) fail(name_, ": cannot be read");
    if (line.empty() && in_.eof()) fail(name_, ": must be a recording, got an empty file");
    if (line + '\n' == openingLine() && !in_.eof()) {
        byte_ = line.size() + 1;
        return;
    }
    if (const std::string older = olderVersion(line); !older.empty()) fail(name_, ": ", older);
    if (line.size() < openingLine().size() && openingLine().starts_with(line) && in_.eof())
        fail(name_, ": cut off at byte ", line.size(), ", before the header of the recording");
    const std::string digits = line.starts_with(kOpening) ? line.substr(kOpening.size()) : "";
    const auto isDigit = [](char c) { return c >= '0' && c <= '9'; };
    if (!digits.empty() && digits.size() < 8 && std::ranges::all_of(digits, isDigit))
        fail(name_, ": the recording has version ", digits, ", but this Filasofia reads version ", kVersion);
    fail(name_, ": this is not a Filasofia recording");
}

void ChunkReader::damaged(std::string_view why) const
{
    throw FileDamage(text(name_, ": damaged at byte ", byte_, ": ", why));
}
void ChunkReader::cutOff() const
{
    throw FileDamage(text(name_, ": cut off at byte ", byte_, ", in the middle of a chunk"));
}

bool ChunkReader::read(std::string& bytes, std::size_t count)
{
    bytes.resize(count);
    in_.read(bytes.data(), static_cast<std::streamsize>(count));
    if (in_.bad()) fail(name_, ": cannot be read");
    bytes.resize(static_cast<std::size_t>(in_.gcount()));
    return bytes.size() == count;
}

bool ChunkReader::next(std::string& content)
{
    std::string header;
    if (!read(header, kChunkHeader)) {
        if (header.empty()) return false;
        cutOff();
    }
    if (!std::string_view(header).starts_with(kChunkMark)) damaged("a chunk must begin here");
    const std::uint32_t number = get(header, 4), size = get(header, 8), storedSize = get(header, 12);
    if (size > kMaximumChunk) damaged(text("a chunk's content must be <= ", kMaximumChunk, " bytes, got ", size));
    if (storedSize > kMaximumStored) damaged(text("a chunk must be <= ", kMaximumStored, " bytes, got ", storedSize));
    std::string stored;
    if (!read(stored, storedSize)) cutOff();
    if (crcOf(std::string_view(header).substr(4, 12), stored) != get(header, 16))
        damaged("the checksum of the chunk does not match");
    if (number != number_) damaged(text("chunk ", number_, " is missing; chunk ", number, " is in its place"));

    // The size is known and small, and zlib writes no further: a chunk that would grow beyond it is refused.
    const std::size_t before = content.size();
    content.resize(before + size);
    uLongf made = size;
    uLong used = storedSize;
    Bytef nothing = 0; // zlib needs a pointer even for no byte
    const int answer = uncompress2(size > 0 ? reinterpret_cast<Bytef*>(content.data() + before) : &nothing, &made,
                                   reinterpret_cast<const Bytef*>(stored.data()), &used);
    if (answer != Z_OK || made != size || used != storedSize) {
        content.resize(before);
        damaged("the chunk does not inflate to its announced size");
    }
    ++number_;
    byte_ += kChunkHeader + storedSize;
    return true;
}

} // namespace filasofia::record
