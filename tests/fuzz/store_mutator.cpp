// Changes a value in the JSON that stands for a store, so that it stays JSON; of texts, which are
// bytes in digits, a few digits.
#include "fuzz/mutation.hpp"

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned seed) {
    using namespace palpate::fuzz;
    Random random(seed + 1);
    std::string text(data, data + size);
    if (one_in(random, 20) || !mutate_json_text(text, random)) {
        return LLVMFuzzerMutate(data, size, most);
    }
    for (unsigned more = random() % 3; more > 0; --more) mutate_json_text(text, random);
    if (text.size() > most) return size;
    std::copy(text.begin(), text.end(), data);
    return text.size();
}
