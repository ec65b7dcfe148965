/* What a program that uses the installed C interface needs: reads a volume and tells of it. */
#include <palpate.h>
#include <stdio.h>
int main(int count, char **words) {
    palpate_volume *volume = NULL;
    PALPATE_STRUCT(palpate_volume_info, info);
    if (count != 2 || palpate_volume_load(words[1], NULL, &volume) != PALPATE_OK ||
        palpate_volume_describe(volume, &info) != PALPATE_OK) {
        puts(palpate_last_error());
        return 1;
    }
    printf("%d samples along x, feel %g\n", info.geometry.size[0], info.isovalue);
    palpate_volume_destroy(volume);
    return 0;
}
