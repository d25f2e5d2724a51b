#pragma once

#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>

namespace filasofia::record {

/// A file being written. Every function throws an Error naming it when it cannot be.
class OutputFile {
public:
    explicit OutputFile(const std::filesystem::path& path);
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    void write(std::string_view text);
    void flush();
    [[nodiscard]] const std::string& name() const { return name_; }

private:
    std::string name_;
    std::FILE* file_ = nullptr;
};

} // namespace filasofia::record
