#pragma once

#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>

namespace filasofia {

/// A file being written, emptied first. Every function throws an Error naming the file if it fails. Only one object at
/// a time writes the same regular file, under any of its names, in any program.
class OutputFile {
public:
    explicit OutputFile(const std::filesystem::path& path);
    ~OutputFile(); ///< closes; to learn of errors, call close() before
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    void write(std::string_view text);
    void flush();
    /// Ends the file. Data on its way to a full disk, or over a network, may fail only here.
    void close();
    [[nodiscard]] const std::string& name() const { return name_; }
    /// True after a failure, which was reported.
    [[nodiscard]] bool failed() const { return failed_; }

private:
    [[noreturn]] void refuse();

    std::string name_;
    std::FILE* file_ = nullptr;
    bool failed_ = false;
};

} // namespace filasofia
