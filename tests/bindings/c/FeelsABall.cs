// A device written in C# feels a ball of 20 mm, while the garbage collector runs.
using System;
using System.IO;
using System.Runtime.InteropServices;
using System.Threading;
using PalpateC;

static class FeelsABall
{
    const int Side = 64;
    static double depth = 30, step = -0.02, force, largest;
    static volatile bool closed;
    static readonly OwnDeviceRead read = Read;
    static readonly OwnDeviceWrite write = Write;
    static readonly OwnDeviceClose close = delegate { closed = true; };

    static int Read(ref Reading reading, IntPtr context)
    {
        // In and out: after a tick that took too long, forces wait for a hand that comes anew.
        if (depth + step < 16 || depth + step > 30) step = -step;
        depth += step;
        reading.Status = 1;
        reading.Position.Z = depth;
        return 0;
    }

    static int Write(ref Wrench wrench, IntPtr context)
    {
        force = wrench.Force.Length;
        largest = Math.Max(largest, force);
        return 0;
    }

    static IntPtr Ball()
    {
        var samples = new float[Side * Side * Side];
        for (int n = 0; n < samples.Length; ++n)
        {
            double x = n % Side - 31.5, y = n / Side % Side - 31.5, z = n / (Side * Side) - 31.5;
            samples[n] = (float)(200 - 5 * Math.Sqrt(x * x + y * y + z * z));
        }
        var geometry = new Geometry
        {
            SizeOf = Native.SizeOf<Geometry>(), Size = new Index3(Side, Side, Side),
            Origin = new Vector(-31.5, -31.5, -31.5)
        };
        IntPtr volume;
        Native.Check(Native.palpate_volume_copy(ref geometry, Constants.Float32, samples,
                                                (UIntPtr)(4 * samples.Length), out volume));
        return volume;
    }

    static void RenderATick(IntPtr volume)
    {
        IntPtr field, renderer;
        Native.Check(Native.palpate_field_create(volume, IntPtr.Zero, out field));
        var options = new RenderOptions
        {
            SizeOf = Native.SizeOf<RenderOptions>(), HasIsovalue = 1, Isovalue = 100,
            StaticFriction = 0.3, DynamicFriction = 0.2, Tool = "sphere:1"
        };
        Native.Check(Native.palpate_renderer_create(field, ref options, IntPtr.Zero, out renderer));
        var hand = new Hand { SizeOf = Native.SizeOf<Hand>(), Position = new Vector(0, 0, 25) };
        var felt = new Felt { SizeOf = Native.SizeOf<Felt>() };
        Native.Check(Native.palpate_renderer_render(renderer, ref hand, ref felt));
        hand.Time = 0.001;
        hand.Position.Z = 20;
        Native.Check(Native.palpate_renderer_render(renderer, ref hand, ref felt));
        Require(felt.Mode == Constants.Constrained && felt.Contacts > 0, "the tool touches");
        Require(Math.Abs(felt.Scp.Z - 21) < 0.2, "it is a sphere of 1 mm");
        Native.palpate_renderer_destroy(renderer);
        options.Tool = "hämmer";
        Require(Native.palpate_renderer_create(field, ref options, IntPtr.Zero, out renderer) != Status.Ok,
                "no such tool");
        Require(Native.LastError.Contains("hämmer"), "its name is UTF-8: " + Native.LastError);
        Native.palpate_field_destroy(field);
    }

    static void ChangeWhatIsFelt(IntPtr run, IntPtr data)
    {
        Native.Check(Native.palpate_run_set_friction(run, 0.3, 0.2));
        Native.Check(Native.palpate_run_set_ranges(run, 1, new double[] { 95, 110, 150, 160 }, (UIntPtr)2));
        Native.Check(Native.palpate_run_set_penetration(run, 0));
        Native.Check(Native.palpate_run_set_layers(run, "ct-needle"));
        Native.Check(Native.palpate_run_change_layers(run, "ct-needle"));
        Native.Check(Native.palpate_run_set_layers(run, null));
        Native.Check(Native.palpate_run_lift(run));
        SetEach(run);
        Require(Native.RunText(run, Constants.TextDevice) == "gerät", "the device's model");
        string folder = Path.Combine(Path.GetTempPath(), "palpate-größe-" + Guid.NewGuid());
        Directory.CreateDirectory(folder);
        string file = Path.Combine(folder, "kugel.mha");
        Native.Check(Native.palpate_data_save(data, file));
        Require(File.Exists(file), "a path is UTF-8");
        IntPtr volume;
        var options = new LoadOptions { SizeOf = Native.SizeOf<LoadOptions>() };
        Native.Check(Native.palpate_volume_load(file, ref options, out volume));
        Native.palpate_volume_destroy(volume);
        Directory.Delete(folder, true);
    }

    /// What is set by any name is what the run has.
    static void SetEach(IntPtr run)
    {
        ulong count = (ulong)Native.palpate_setting_count();
        Require(count > 20, "there are settings");
        for (ulong i = 0; i < count; ++i)
        {
            var setting = new Setting { SizeOf = Native.SizeOf<Setting>() };
            Native.Check(Native.palpate_setting_describe((UIntPtr)i, ref setting));
            string name = Native.Text(setting.Name);
            double before, after;
            Native.Check(Native.palpate_run_get(run, name, out before));
            if (before == 0 && name.StartsWith("limits.")) continue; // a limit cannot be raised
            double small = name.EndsWith("distance") ? 1 : 1e-4; // the pull of a magnet is bounded over it
            double factor = name == "limits.delay" ? 1.1 : 0.9; // a delay can only be raised
            double wanted = double.IsInfinity(before) ? 7 : before == 0 ? small : factor * before;
            Native.Check(Native.palpate_run_set(run, name, wanted));
            Native.Check(Native.palpate_run_get(run, name, out after));
            Require(after == wanted && after != before, name);
        }
    }

    static IntPtr Run(IntPtr data)
    {
        var render = new RenderOptions
        {
            SizeOf = Native.SizeOf<RenderOptions>(), HasIsovalue = 1, Isovalue = 100, Scale = 1,
            Stiffness = 0.4
        };
        var own = new OwnDevice
        {
            SizeOf = Native.SizeOf<OwnDevice>(), Name = "csharp", Model = "gerät", MaximumForce = 2, Read = read,
            Write = write, Close = close, Rate = 500
        };
        using (var unmanagedRender = new Unmanaged<RenderOptions>(render))
        using (var unmanagedOwn = new Unmanaged<OwnDevice>(own))
        {
            var options = new RunOptions
            {
                SizeOf = Native.SizeOf<RunOptions>(), Render = unmanagedRender.Pointer,
                Own = unmanagedOwn.Pointer, NoRealTime = 1
            };
            IntPtr run, another;
            Native.Check(Native.palpate_run_create(data, ref options, out run));
            Require(Native.palpate_run_create(data, ref options, out another) == Status.NoDevice,
                    "a device serves one run at a time");
            return run;
        }
    }

    static void Require(bool isTrue, string what)
    {
        if (!isTrue) throw new Exception("not so: " + what);
    }

    static void Main()
    {
        Marshal.PrelinkAll(typeof(Native)); // every function is in the library
        IntPtr volume = Ball(), data;
        RenderATick(volume);
        Native.Check(Native.palpate_data_create(volume, out data));
        Native.palpate_volume_destroy(volume);
        IntPtr run = Run(data);
        Native.Check(Native.palpate_run_start(run));
        // On a busy machine a reading may be older than 20 ms every time, and the force would never rise.
        Native.Check(Native.palpate_run_set(run, "force.stale_after", 3600));
        var snapshot = new Snapshot { SizeOf = Native.SizeOf<Snapshot>() };
        while (largest < 1 || snapshot.Felt.Force.Length < 1) // however long a busy machine takes
        {
            Status status = Native.palpate_run_snapshot(run, ref snapshot);
            if (status != Status.NothingYet) Native.Check(status);
            GC.Collect();
            Thread.Sleep(16);
        }
        Require(largest <= 2, "the device's limit");
        Require(snapshot.Felt.Mode == 1 && snapshot.ForcesOn == 1, "contact");
        Require(Math.Abs(snapshot.Felt.Scp.Length - 20) < 0.2, "the proxy is on the ball");
        Require(snapshot.Transform.Scale == 1, "the scale");
        Require(Native.palpate_run_set_isovalue(run, double.NaN) == Status.Invalid, "a refusal");
        ChangeWhatIsFelt(run, data);
        Native.palpate_run_destroy(run);
        Require(closed && force == 0, "the last force is zero, then the device is closed");
        Native.palpate_data_destroy(data);
        Console.WriteLine("palpate {0}: largest force {1:F2} N, proxy at {2:F2} mm", Native.Version,
                          largest, snapshot.Felt.Scp.Length);
    }
}
