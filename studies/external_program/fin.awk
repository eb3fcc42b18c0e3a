# A cooling fin that also radiates: k A T'' = P (h (T - Ta) + eps sigma (T^4 - Ta^4)), T(0) = Tb,
# insulated tip. Central differences, radiation linearised about the last temperatures.
# Reads `name value` lines; writes profile.csv (x in m, T in K); prints tip and heat.

{ value[$1] = $2 }

END {
    n = 40; dx = value["length"] / n; sigma = 5.670374419e-8
    Tb = value["base"]; Ta = value["ambient"]; k = value["conductivity"]
    m = 4 / (k * value["diameter"])            # perimeter / (k area) of a round fin
    for (i = 0; i <= n; i++) T[i] = Tb
    for (round = 1; round <= 100; round++) {
        # (T[i-1] - 2 T[i] + T[i+1]) / dx^2 = m H[i] (T[i] - Ta), H with linearised radiation
        c[0] = 0; d[0] = Tb
        for (i = 1; i <= n; i++) {
            H = value["h"] + value["emissivity"] * sigma * (T[i]^2 + Ta^2) * (T[i] + Ta)
            a = (i < n) ? -1 : -2
            b = 2 + dx^2 * m * H
            r = dx^2 * m * H * Ta
            w = b - a * c[i-1]
            c[i] = (i < n) ? -1 / w : 0
            d[i] = (r - a * d[i-1]) / w
        }
        change = 0
        for (i = n; i >= 0; i--) {
            new = d[i] - ((i < n) ? c[i] * T[i+1] : 0)
            if ((new - T[i])^2 > change) change = (new - T[i])^2
            T[i] = new
        }
        if (change < 1e-16) break
    }
    if (change >= 1e-16) { print "no convergence, last change " sqrt(change) " K"; exit 3 }
    print "x,T" > "profile.csv"
    for (i = 0; i <= n; i++) printf "%.6g,%.10g\n", i * dx, T[i] > "profile.csv"
    area = 3.14159265358979 * value["diameter"]^2 / 4
    printf "rounds %d\ntip temperature = %.10g K\nheat flow = %.10g W\n", round, T[n], \
        -k * area * (-3 * T[0] + 4 * T[1] - T[2]) / (2 * dx)
}
