// Mutates messages of the Inverse Service, one by one: most stay JSON, with one value
// changed, left out or copied.
#include "fuzz/mutation.hpp"

using namespace palpate::fuzz;

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned seed) {
    Random random(seed + 1);
    auto lines = lines_of({reinterpret_cast<const char*>(data), size});
    if (lines.empty() || one_in(random, 8)) return LLVMFuzzerMutate(data, size, most);
    const std::size_t at = random() % lines.size();
    if (one_in(random, 8)) {
        std::swap(lines[at], one_of(lines, random));
    } else if (one_in(random, 8)) {
        lines.insert(lines.begin() + std::ptrdiff_t(at), std::string(one_of(lines, random)));
    } else if (!mutate_json_text(lines[at], random)) {
        return LLVMFuzzerMutate(data, size, most);
    }
    return put_lines(lines, data, most);
}
