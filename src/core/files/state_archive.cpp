#include "core/files/state_archive.h"

#include <istream>
#include <ostream>

namespace photonlab {

std::uint64_t StateArchive::exchange_count(std::uint64_t count, std::uint64_t bytes_each) {
    exchange(count);
    if (reads() && count > left_ / bytes_each)
        throw InputError("claims " + std::to_string(count) + " values of " + std::to_string(bytes_each) +
                         " bytes where " + std::to_string(left_) + " bytes are left");
    return count;
}

void StateArchive::move_bytes(void* bytes, std::uint64_t count) {
    if (count == 0) return;
    if (output_) {
        output_->write(static_cast<const char*>(bytes), static_cast<std::streamsize>(count));
    } else {
        if (count > left_ || !input_->read(static_cast<char*>(bytes), static_cast<std::streamsize>(count)))
            throw InputError("ends before its state does");
        left_ -= count;
    }
    hash_.add(bytes, count);
}

}  // namespace photonlab
