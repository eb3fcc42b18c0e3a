# A quarter of a plate with a central hole, in 8-node elements, as an include file of CalculiX:
#     awk -v d=DIAMETER -v w=WIDTH -v l=LENGTH -f mesh.awk > mesh.inp
# x along the plate and the load, y across it, the hole's middle at the origin. Node 1 is at the
# hole's edge on the y-axis, where the stress is largest.

function node(i, j)     { return 1 + i + (2 * nr + 1) * j }              # ring: outwards, round
function strip(a, b)    { return a ? ring + a + 2 * nx * b : node(2 * nr, 4 * nt - b) }
function tan(angle)     { return sin(angle) / cos(angle) }
function at(n, x, y)    { printf "%d, %.12g, %.12g\n", n, x, y }
function share(k)       { return grow == 1 ? k / nr : (grow ^ k - 1) / (grow ^ nr - 1) }
function place(i)       { return (share(int(i / 2)) + share(int((i + 1) / 2))) / 2 }
function grade(first,    low, high) {        # grow so that the first element has this share
    low = 0.5; high = 3
    while (high - low > 1e-9) {
        grow = (low + high) / 2
        if (share(1) > first) low = grow; else high = grow
    }
}

BEGIN {
    nr = 20; nt = 12; nx = 10                 # elements outwards, in 45 degrees, along the strip
    pi = 3.14159265358979; r = d / 2; h = w / 2
    grade(pi / 4 / nt * r / (h - r))          # elements at the hole are as long as wide
    ring = (2 * nr + 1) * (4 * nt + 1)

    print "*NODE, NSET=ALL"
    for (j = 0; j <= 4 * nt; j++) {
        angle = pi / 2 * (1 - j / (4 * nt))
        c = cos(angle); s = sin(angle); far = h / (c > s ? c : s)
        if (j == 0) c = 0; if (j == 4 * nt) s = 0
        for (i = 0; i <= 2 * nr; i++)
            if (i % 2 == 0 || j % 2 == 0)
                at(node(i, j), (r + (far - r) * place(i)) * c, (r + (far - r) * place(i)) * s)
    }
    for (b = 0; b <= 2 * nt; b++)             # the strip from the ring's square to the end
        for (a = 1; a <= 2 * nx; a++)
            if (a % 2 == 0 || b % 2 == 0)
                at(strip(a, b), h + (l / 2 - h) * a / (2 * nx), h * tan(pi / 8 * b / nt))

    print "*ELEMENT, TYPE=CPS8, ELSET=PLATE"
    for (j = 0; j < 4 * nt; j += 2)
        for (i = 0; i < 2 * nr; i += 2)
            printf "%d, %d, %d, %d, %d, %d, %d, %d, %d\n", ++e, \
                node(i, j), node(i, j + 2), node(i + 2, j + 2), node(i + 2, j), \
                node(i, j + 1), node(i + 1, j + 2), node(i + 2, j + 1), node(i + 1, j)
    for (b = 0; b < 2 * nt; b += 2)
        for (a = 0; a < 2 * nx; a += 2) {
            printf "%d, %d, %d, %d, %d, %d, %d, %d, %d\n", ++e, \
                strip(a, b), strip(a + 2, b), strip(a + 2, b + 2), strip(a, b + 2), \
                strip(a + 1, b), strip(a + 2, b + 1), strip(a + 1, b + 2), strip(a, b + 1)
            if (a == 2 * nx - 2) end[++ends] = e
        }

    print "*ELSET, ELSET=END"                 # its second side is loaded
    for (k = 1; k <= ends; k++) print end[k] ","
    print "*NSET, NSET=MIDDLE"                # x = 0
    for (i = 0; i <= 2 * nr; i++) print node(i, 0) ","
    print "*NSET, NSET=AXIS"                  # y = 0
    for (i = 0; i <= 2 * nr; i++) print node(i, 4 * nt) ","
    for (a = 1; a <= 2 * nx; a++) print strip(a, 0) ","
    print "*NSET, NSET=TIP"
    print strip(2 * nx, 0) ","
}
