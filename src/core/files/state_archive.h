// Writing and reading the state of something in one function: `exchange(StateArchive&)` names each value once, and
// whether the archive writes or reads decides which way it goes, so that what is saved is what is restored.
//
// Values are stored as they lie in memory, for the machine and the program that wrote them; whoever keeps an archive
// says of what it is (render/checkpoint.h).
//
// States of disjoint passes can be joined: a reader that joins adds to what is there where a value is a sum, keeps the
// larger where it is a maximum, and replaces the rest, which is then that of the state that was read last.

#pragma once

#include <cstdint>
#include <functional>
#include <iosfwd>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "core/error.h"
#include "core/hash.h"

namespace photonlab {

/// A number, or a struct of numbers without gaps: what lies in a gap is no value, and states would not be the same
/// bits. No compiler of ours can tell; tests/integrators/continuation_test.cpp does.
template <typename Value>
concept PlainValue =
    std::is_standard_layout_v<Value> && std::is_trivially_destructible_v<Value> && !std::is_pointer_v<Value>;

class StateArchive {
public:
    /// Writes to a stream, whose failures are its owner's to notice.
    explicit StateArchive(std::ostream& output) : output_(&output) {}

    /// Reads `bytes` bytes of a stream.
    StateArchive(std::istream& input, std::uint64_t bytes) : input_(&input), left_(bytes) {}

    bool reads() const { return input_ != nullptr; }

    /// True when what is read joins what is there.
    bool joins() const { return joins_; }
    void begin_joining() { joins_ = true; }

    /// Writes the value, or replaces it by what was written. Reading throws InputError when the archive ends before.
    template <PlainValue Value>
    void exchange(Value& value) {
        move_bytes(&value, sizeof(Value));
    }

    template <typename Value>
    void exchange(std::optional<Value>& value) {
        std::uint8_t is_there = value.has_value() ? 1 : 0;
        exchange(is_there);
        if (is_there > 1) throw InputError("expected 0 or 1 before a value, got " + std::to_string(is_there));
        if (is_there == 0) {
            value.reset();
            return;
        }
        if (!value) value.emplace();
        exchange(*value);
    }

    void exchange(std::string& text) {
        text.resize(exchange_count(text.size(), 1));
        move_bytes(text.data(), text.size());
    }

    template <PlainValue Value>
    void exchange(std::vector<Value>& values) {
        values.resize(exchange_count(values.size(), sizeof(Value)));
        move_bytes(values.data(), values.size() * sizeof(Value));
    }

    /// The same for as many values as there are already: reading throws InputError when another number was written.
    template <PlainValue Value>
    void exchange_as_many(std::vector<Value>& values) {
        const std::uint64_t count = exchange_count(values.size(), sizeof(Value));
        if (count != values.size())
            throw InputError("expected " + std::to_string(values.size()) + " values, got " + std::to_string(count));
        move_bytes(values.data(), values.size() * sizeof(Value));
    }

    /// A number that is a sum over passes.
    template <typename Number>
    void exchange_sum(Number& sum) {
        exchange_joined(sum, [](Number& here, const Number& read) { here += read; });
    }

    /// A number that is the largest of all passes.
    template <typename Number>
    void exchange_largest(Number& largest) {
        exchange_joined(largest, [](Number& here, const Number& read) {
            if (read > here) here = read;
        });
    }

    /// A value of which `join(here, read)` says what becomes of two.
    template <PlainValue Value, typename Join>
    void exchange_joined(Value& value, const Join& join) {
        if (!joins_) return exchange(value);
        Value read = value;
        exchange(read);
        join(value, read);
    }

    /// Each element by `exchange_one(archive, element)`; for elements that are not plain.
    template <typename Value, typename ExchangeOne>
    void exchange_each(std::vector<Value>& values, const ExchangeOne& exchange_one) {
        values.resize(exchange_count(values.size(), 1));
        for (Value& value : values) exchange_one(*this, value);
    }

    /// Leaves what follows unread.
    void skip_rest() { left_ = 0; }

    std::uint64_t bytes_left() const { return left_; }  ///< to be read
    std::string hash() const { return hash_.text(); }   ///< of all bytes that were written or read

private:
    /// How many elements follow; when reading, no more than the bytes that are left can hold.
    std::uint64_t exchange_count(std::uint64_t count, std::uint64_t bytes_each);
    void move_bytes(void* bytes, std::uint64_t count);

    std::ostream* output_ = nullptr;
    std::istream* input_ = nullptr;
    std::uint64_t left_ = 0;
    bool joins_ = false;
    RunningHash hash_;
};

/// Writes or reads the state of one thing.
using StateExchange = std::function<void(StateArchive&)>;

}  // namespace photonlab
