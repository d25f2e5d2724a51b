#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace filasofia::device {

/// The newest value of a type that one thread writes and any number of threads read (a sequence lock). Nobody waits: if
/// the writer interferes with a read eight times, the reader keeps its old value, as a real-time thread must if the
/// writer lost its core.
template <class T> class Latest {
    static_assert(std::is_trivially_copyable_v<T>);

public:
    void write(const T& value) // one thread only
    {
        Words words{};
        std::memcpy(words.data(), &value, sizeof value);
        const std::uint64_t version = version_.load(std::memory_order_relaxed);
        version_.store(version + 1, std::memory_order_relaxed); // odd: a write is in progress
        for (std::size_t i = 0; i < words.size(); ++i) words_[i].store(words[i], std::memory_order_release);
        version_.store(version + 2, std::memory_order_release);
    }

    /// False, with `out` unchanged, if nothing was written yet or the writer interfered.
    [[nodiscard]] bool read(T& out) const
    {
        constexpr int attempts = 8;
        for (int i = 0; i < attempts; ++i) {
            const std::uint64_t version = version_.load(std::memory_order_acquire);
            if (version == 0 || version % 2 != 0) continue;
            Words words;
            for (std::size_t k = 0; k < words.size(); ++k) words[k] = words_[k].load(std::memory_order_acquire);
            if (version_.load(std::memory_order_relaxed) != version) continue;
            std::memcpy(static_cast<void*>(&out), words.data(), sizeof out);
            return true;
        }
        return false;
    }

private:
    static constexpr std::size_t kWords = (sizeof(T) + 7) / 8;
    using Words = std::array<std::uint64_t, kWords>;

    std::atomic<std::uint64_t> version_ = 0;
    std::array<std::atomic<std::uint64_t>, kWords> words_ = {};
};

} // namespace filasofia::device
