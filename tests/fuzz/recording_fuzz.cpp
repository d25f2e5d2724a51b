#include "filasofia/core/error.h"
#include "filasofia/core/log.h"
#include "filasofia/record/recording.h"
#include "filasofia/scene/scene_file.h"

#include "filasofia/record/chunks.h"

#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <fstream>

// If the input begins like a recording, it is read as a whole file. Otherwise it is the content of a file's chunks, in
// chunks of a size given by the first byte: checksums would keep the fuzzer from everything behind them. It is read
// twice: step by step, and as a scene, which stops at what a scene cannot hold.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    using namespace filasofia;
    setLogSink([](LogLevel, std::string_view) {});
    static const std::string file = "/dev/shm/filasofia_recording_fuzz_" + std::to_string(getpid());
    std::string bytes(reinterpret_cast<const char*>(data), size);
    if (size > 0 && !bytes.starts_with("filas")) {
        const std::string content = bytes.substr(1);
        // Each chunk is deflated, which takes a thousand times as long as reading it. Eight chunks are enough for an
        // end at any place.
        const std::size_t length = std::max<std::size_t>(1 + 16u * data[0], (content.size() + 7) / 8);
        bytes = record::openingLine();
        std::uint32_t number = 0;
        for (std::size_t at = 0; at < content.size(); at += length)
            bytes += record::chunkOf(number++, std::string_view(content).substr(at, length));
    }
    std::ofstream(file, std::ios::binary) << bytes;
    try {
        record::RecordingReader reader(file);
        while (reader.next()) reader.takeScene();
    } catch (const Error&) {
    }
    try {
        static_cast<void>(scene::sceneOf(file));
    } catch (const Error&) {
    }
    std::remove(file.c_str());
    return 0;
}
