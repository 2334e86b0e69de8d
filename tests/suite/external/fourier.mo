//@ case spectrum_of_samples
package P
  function spectrum
    input Real u[:];
    output Integer info;
    output Real amplitudes[div(size(u, 1), 2) + 1];
    output Real phases[div(size(u, 1), 2) + 1];
  protected
    Real work[3*size(u, 1) + 2*(div(size(u, 1), 2) + 1)];
  external "C" info = ModelicaFFT_kiss_fftr(u, size(u, 1), work, size(work, 1), amplitudes, phases);
  end spectrum;
  model Sampled
    Integer n(start = 0, fixed = true);
    Real u[12](each start = 0, each fixed = true);
    Real a[7](each start = 0, each fixed = true);
    Real p[7](each start = 0, each fixed = true);
    Integer info(start = -1, fixed = true);
  algorithm
    when sample(0, 0.05) then
      n := pre(n) + 1;
      if n <= 12 then
        u[n] := 3*cos(2*3.14159265358979*(n - 1)/4 + 0.5);
      end if;
    end when;
    when n >= 12 then
      (info, a, p) := spectrum(u);
    end when;
  end Sampled;
end P;
//@ expect info = 0
// Three waves in twelve samples; the library divides by the number of terms, 7, instead of 6.
//@ expect a[4] = 3*6/7 rel 1e-12
//@ expect p[4] = 0.5 rel 1e-12
//@ expect a[1:3], a[5:7] = 0 abs 1e-12
